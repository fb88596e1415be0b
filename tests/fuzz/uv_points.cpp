// What `eval --input` reads: the first byte picks among its formats.
#include "cli/eval_input.h"
#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  fuzz::Bytes bytes(data, size);
  const std::size_t which = bytes.take<std::uint8_t>() % point_format_names.size();
  const std::string path = fuzz::in_file(fuzz::text_of(data, size).substr(size > 0 ? 1 : 0), ".points");
  fuzz::may_refuse([&] {
    const auto input = open_points(path, static_cast<PointFormat>(which));
    const auto stated = input->count();
    std::uint64_t got = 0;
    PointBlocks blocks(16, [&](std::span<const double> u, std::span<const double> v) {
      fuzz::expect(!u.empty() && u.size() == v.size() && u.size() <= 16, "blocks as large as was asked for");
      got += u.size();
    });
    input->read(blocks);
    blocks.pass_on();
    fuzz::expect(!stated || *stated == got, "as many points as were stated");
  });
  return 0;
}
