// Results files of studies: resumed, and merged.
#include "study/study.h"
#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  using Json = nlohmann::ordered_json;
  const std::string path = fuzz::in_file(fuzz::text_of(data, size), ".jsonl");
  fuzz::may_refuse([&] { merge_results({path}, "1"); });
  const StudyIdentity identity{"converge", "1", Json{{"a", 1}}, Json{{"machine", "none"}}};
  const auto job = [](int i) { return Job{"job " + std::to_string(i), [i] { return Json(i); }}; };
  fuzz::may_refuse([&] {
    const std::vector<Json> results =
        run_study(identity, {job(0), job(1)}, {.results = path, .shard = {}, .threads = 1}, [](double) {});
    fuzz::expect(results.size() == 2 && !results[0].is_null() && !results[1].is_null(), "a result per job");
    fuzz::expect(!merge_results({path}, "1").empty(), "what was resumed can be merged");
  });
  return 0;
}
