// Studies as files, of the commands that read them; the first byte picks the command.
#include "cli/converge_study.h"
#include "cli/stability_study.h"
#include "cli/work_precision_study.h"
#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  if (size == 0) return 0;
  const std::string path = fuzz::in_file(fuzz::text_of(data + 1, size - 1), ".json");
  const auto grow = [](const std::vector<int>& list, int most) {
    for (std::size_t i = 0; i < list.size(); ++i)
      fuzz::expect(list[i] >= 2 && list[i] <= most && (i == 0 || list[i] > list[i - 1]), "resolutions grow");
  };
  fuzz::may_refuse([&] {
    switch (data[0] % 3) {
      case 0: {
        ConvergeChoices choices;
        read_converge_study(path, choices);
        grow(choices.resolutions, finest_rows);
        fuzz::expect(choices.resolutions.size() >= 3, "an order of convergence needs three resolutions");
        fuzz::expect(0 <= choices.v_first && choices.v_first < choices.v_last && choices.v_last <= 1,
                     "a range of v");
        fuzz::expect(choices.seeds >= 1 && choices.seeds <= most_seeds, "a number of meshes");
        break;
      }
      case 1: {
        StabilityChoices choices;
        read_stability_study(path, choices);
        fuzz::expect(choices.points >= 2 && choices.points <= most_points, "a number of points");
        fuzz::expect(choices.samples >= 1 && choices.samples <= most_points, "a number of samples");
        break;
      }
      default: {
        WorkChoices choices;
        read_work_study(path, choices);
        grow(choices.resolutions, finest_work_rows);
        fuzz::expect(choices.timeout > 0, "a time");
        fuzz::expect(choices.points >= 16 && choices.points <= most_work_points, "a number of points");
      }
    }
  });
  return 0;
}
