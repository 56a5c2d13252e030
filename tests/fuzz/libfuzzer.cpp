/* libFuzzer's program: it fuzzes the target that it is called by. */
#include "fuzz/fuzz.hpp"

#include <cstdio>
#include <cstdlib>

extern "C" size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);

static const fuzz::Target *target;

namespace fuzz {
size_t mutate_bytes(uint8_t *data, size_t size, size_t most)
{
    return LLVMFuzzerMutate(data, size, most);
}
} // namespace fuzz

extern "C" int LLVMFuzzerInitialize(int *, char ***arguments)
{
    std::string name = (*arguments)[0];
    name.erase(0, name.rfind('/') + 1);
    for (size_t i = 0; i < fuzz::target_count; ++i)
        if (name == fuzz::targets[i].name)
            target = &fuzz::targets[i];
    if (!target) {
        std::fprintf(stderr, "there is no target '%s'\n", name.c_str());
        std::exit(1);
    }
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    target->run(data, size);
    return 0;
}

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    return target->mutate ? target->mutate(data, size, most, seed)
                          : LLVMFuzzerMutate(data, size, most);
}
