/* What gtx horizons, filter and pack tell a build: sources, a report, warnings, and no change. */
#include "common/schema.hpp"

#include <fstream>
#include <sstream>

extern "C" {
#include "cli/command.h"
}

using schema::json;

static std::string text_of(const char *name)
{
    std::ifstream file(in_folder(name));
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

static json report()
{
    const json report = json::parse(text_of("r.json"));
    const json rules = schema::load("format/made-report.schema.json");
    const std::string why = schema::broken(report, rules, rules);
    if (!why.empty())
        fail_msg("%s", why.c_str());
    return report;
}

/* A verb with its operands, what it reads, and what of that to alter so that the result differs. */
struct Case {
    const char *verb, *arguments;
    std::vector<std::string> sources;
    const char *alter;
};

static const Case cases[] = {
    {"horizons", "a.irap=b.irap", {"a.irap", "b.irap"},
     "sed -i 's/^5 6/5 9/' a.irap"},
    {"filter", "sphere.gtx --gaussian 1 --pattern dot.pgm --lod-levels 0",
     {"sphere.gtx", "dot.pgm"}, "printf 'P2\\n2 2\\n9\\n9 1\\n2 0\\n' >dot.pgm"},
    {"pack", "maps --rebuild mips", {}, "cp other/color-0-0.png maps/"},
};

static void write_inputs()
{
    std::ofstream(in_folder("a.irap"))
        << "-996 2 10 10\n0 10 0 10\n2 0 0 0\n0 0 0 0 0 0 0\n5 6 7 8\n";
    std::ofstream(in_folder("b.irap"))
        << "-996 2 10 10\n0 10 0 10\n2 0 0 0\n0 0 0 0 0 0 0\n1 2 3 4\n";
    std::ofstream(in_folder("dot.pgm")) << "P2\n2 2\n9\n0 1\n2 9\n";
    std::ofstream(in_folder("c.obj")) << "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n";
    std::ofstream(in_folder("d.obj")) << "v 0 0 0 0 0 1\nv 1 0 0 0 0 1\nv 0 1 0 0 0 1\nf 1 2 3\n";
    expect(gtx("cook c.obj -q -o c.gtx"), 0);
    expect(gtx("cook d.obj -q -o d.gtx"), 0);
    expect(gtx("unpack c.gtx maps"), 0);
    expect(gtx("unpack d.gtx other"), 0);
}

static void each_tells_what_it_read_and_made(void **)
{
    write_inputs();
    for (const Case &c : cases) {
        const std::string command = std::string(c.verb) + " " + c.arguments + " -o x.gtx";
        expect(gtx("%s --report r.json --depfile x.d", command.c_str()), 0);
        const json told = report();
        const std::vector<std::string> sources = told["sources"];
        if (!c.sources.empty())
            assert_true(sources == c.sources);
        assert_string_equal(told["verb"].get<std::string>().c_str(), c.verb);
        assert_false(told["unchanged"].get<bool>());
        assert_int_equal(told["bytes"].get<size_t>(), text_of("x.gtx").size());
        const std::string rule = text_of("x.d");
        assert_int_equal(rule.find("x.gtx:"), 0);
        assert_true(sources.size() > 1);
        for (const std::string &source : sources)
            if (rule.find(source + "\n") == std::string::npos &&
                rule.find(source + " \\\n") == std::string::npos)
                fail_msg("%s is not in %s", source.c_str(), rule.c_str());
        assert_true(rule.find(sources[0] + ":\n") != std::string::npos);
    }
}

static void what_is_the_same_is_left_alone(void **)
{
    for (const Case &c : cases) {
        const std::string command = std::string(c.verb) + " " + c.arguments + " -o x.gtx";
        expect(gtx("%s", command.c_str()), 0);
        run_shell("touch -d 2001-01-01 x.gtx && cp -p x.gtx y.gtx");
        expect(gtx("%s --if-changed --report r.json", command.c_str()), 0);
        assert_true(report()["unchanged"].get<bool>());
        run_shell("test ! x.gtx -nt y.gtx");
        run_shell(c.alter);
        expect(gtx("%s --if-changed --report r.json", command.c_str()), 0);
        assert_false(report()["unchanged"].get<bool>());
        run_shell("test x.gtx -nt y.gtx && ! cmp -s x.gtx y.gtx");
        run_shell("printf x >>x.gtx"); /* longer than what would be written */
        expect(gtx("%s --if-changed --report r.json", command.c_str()), 0);
        assert_false(report()["unchanged"].get<bool>());
    }
}

static void a_warning_is_an_error_unless_allowed(void **)
{
    const char *bare = "filter sphere.gtx --gaussian 1 --lod-levels 0 -o no.gtx";
    expect(gtx("cook sphere.obj -q -o sphere.gtx --lod-levels 1"), 0);
    expect(gtx("%s --strict", bare), 3);
    expect_text("sphere.gtx: error[input]: the LOD meshes are those");
    expect_text("(lod-dropped)");
    assert_false(exists("no.gtx"));
    expect(gtx("%s --strict --allow lod-droped", bare), 1);
    expect_text("there is no warning to allow of the name lod-droped");
    expect(gtx("%s --allow lod-dropped", bare), 1);
    assert_false(exists("no.gtx"));
    expect(gtx("%s --strict --allow maps-disagree,lod-dropped --report r.json", bare), 0);
    expect_text("warning[lod-dropped]");
    assert_true(report()["warning_names"] == json::array({"lod-dropped"}));
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(each_tells_what_it_read_and_made),
        cmocka_unit_test(what_is_the_same_is_left_alone),
        cmocka_unit_test(a_warning_is_an_error_unless_allowed),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
