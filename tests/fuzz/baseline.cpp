// An earlier report of validate: compared with one of a file that has two meshes.
#include "cli/validate_files.h"
#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  const std::string path = fuzz::in_file(fuzz::text_of(data, size), ".json");
  fuzz::may_refuse([&] {
    const Json baseline = read_baseline(path);
    std::vector<AssessedFile> files{{.path = "a.glb", .verdict = Verdict::fail},
                                    {.path = "b.glb", .error = "no"}};
    files[0].primitives.resize(2);
    for (AssessedPrimitive& p : files[0].primitives) {
      p.assessments.resize(1);
      p.own_severities.resize(1);
    }
    files[0].primitives[1].primitive.mesh = 1;
    compare_with_baseline(files, path, baseline);
  });
  return 0;
}
