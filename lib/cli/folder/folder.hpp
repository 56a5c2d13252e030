/* Cooking folders: the models in them, and what became of each. */
#pragma once

#include "cli/folder/folder.h"
#include "mesh/task.hpp"

namespace gtx {

/* A model to cook. What happened to it is there once it has been tried. */
struct FolderModel {
    std::string model, asset;    /* paths */
    std::string name;            /* of the asset below the output folder; what a shard goes by */
    bool tried = false;
    int code = EXIT_CODE_OK;
    gtx_result result = GTX_OK;
    std::string failure;         /* one sentence, where it failed */
    std::string report;          /* of the cook, JSON */
    bool unchanged = false, cached = false;
};

/* A place that could not be looked into. */
struct FolderFault {
    std::string path, sentence;
};

struct Folders {
    Vector<FolderModel> models;  /* sorted by name */
    Vector<FolderFault> faults;
};

/* The models of the operands, which are folders and models, and where their assets go: below
 * `output` as the models lie below their folder, with ".gtx" in the place of the extension. Names
 * that begin with a dot are passed over; links are followed, each folder is entered once. Throws
 * Error: ARGUMENT, where two models would give one asset; READ, an operand that is not there. */
Folders find_models(const char *const *operands, int count, const std::string &output);

/* Leaves the models of part `shard` of `shards`, 1 being the first: each model is in one of them,
 * whatever else lies in the folders. */
void keep_shard(Folders &folders, uint32_t shard, uint32_t shards);

/* As format/folder-report.schema.json; `failed` and the like are counted from the models. */
struct FolderCounts {
    uint64_t cooked = 0, unchanged = 0, cached = 0, failed = 0, untried = 0;
};
FolderCounts count_models(const Folders &folders);
std::string write_folder_report(const Folders &folders, const folder_cook &job, int code,
                                double seconds);

} // namespace gtx
