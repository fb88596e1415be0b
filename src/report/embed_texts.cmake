# Writes OUTPUT, a C++ source that defines `extern const std::span<const std::pair<std::string_view, std::string_view>>
# NAME`: of each file in INPUTS its name without folder and extension, and its text.
set(texts "")
foreach(input IN LISTS INPUTS)
  cmake_path(GET input STEM stem)
  file(READ ${input} text)
  string(APPEND texts "    {\"${stem}\", R\"darboux(${text})darboux\"},\n")
endforeach()
file(WRITE ${OUTPUT} "#include <span>
#include <string_view>
#include <utility>
namespace {
constexpr std::pair<std::string_view, std::string_view> texts[] = {
${texts}};
}
namespace darboux {
extern const std::span<const std::pair<std::string_view, std::string_view>> ${NAME};
const std::span<const std::pair<std::string_view, std::string_view>> ${NAME}{texts};
}
")
