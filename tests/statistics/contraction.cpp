// What a program's own compiler options change of single points, for contraction.sh:
//   contraction FILE           writes position, partials and frame of every surface at 20 000 points to FILE
//   contraction --compare A B  prints a table of how far two such files are apart, a row per surface
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/catalogue.h>
#include <darboux/evaluate.h>

namespace {

using namespace darboux;

constexpr int points = 20000;
constexpr std::size_t vectors = 9;  // position, five partials, t, b, n

template <class X>
void write_points(const X& surface, std::FILE* file) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> coordinate(0, 1);
  for (int i = 0; i < points; ++i) {
    const double u = coordinate(random), v = coordinate(random);
    const Jet2<double> j = jet(surface, u, v);
    const Frame<double> f = frame(surface, u, v);
    for (const Vec3<double>& a : {j.position, j.dpdu, j.dpdv, j.d2pdu2, j.d2pduv, j.d2pdv2, f.t, f.b, f.n})
      std::fwrite(&a, sizeof a, 1, file);
  }
}

std::vector<Vec3<double>> read(const char* name) {
  std::FILE* file = std::fopen(name, "rb");
  if (!file) throw std::runtime_error(std::string(name) + ": cannot be read");
  std::vector<Vec3<double>> result;
  for (Vec3<double> a; std::fread(&a, sizeof a, 1, file) == 1;) result.push_back(a);
  std::fclose(file);
  return result;
}

void compare(const char* a, const char* b) {
  const std::vector<Vec3<double>> one = read(a), other = read(b);
  if (one.size() != other.size()) throw std::runtime_error("two files of the same size expected");
  std::printf("| surface | position | first partials | second partials | t, b, n | only in one |\n");
  std::printf("|---|---:|---:|---:|---:|---:|\n");
  std::size_t at = 0;
  Catalogue::for_each([&](const auto& surface) {
    double largest[vectors] = {}, apart[vectors] = {};
    int lost = 0;  // vectors that only one of the two has
    for (int i = 0; i < points; ++i)
      for (std::size_t k = 0; k < vectors; ++k, ++at) {
        const bool a_frame = norm(one[at]) < 1e300, b_frame = norm(other[at]) < 1e300;
        lost += a_frame != b_frame;
        if (!a_frame || !b_frame) continue;
        largest[k] = std::fmax(largest[k], norm(one[at]));
        apart[k] = std::fmax(apart[k], norm(one[at] - other[at]));
      }
    const auto worst = [&](std::size_t from, std::size_t to) {
      double u = 0;
      for (std::size_t k = from; k < to; ++k)
        u = std::fmax(u, apart[k] > 0 ? apart[k] / largest[k] / 0x1p-53 : 0);
      return u;
    };
    std::printf("| %s | %.2g | %.2g | %.2g | %.2g | %d |\n", std::string(surface.info.name).c_str(),
                worst(0, 1), worst(1, 3), worst(3, 6), worst(6, 9), lost);
  });
}

}  // namespace

int main(int count, char** arguments) try {
  if (count == 4 && std::string_view(arguments[1]) == "--compare") {
    compare(arguments[2], arguments[3]);
    return 0;
  }
  std::FILE* file = count == 2 ? std::fopen(arguments[1], "wb") : nullptr;
  if (!file) throw std::runtime_error("contraction FILE, or contraction --compare A B");
  Catalogue::for_each([&](const auto& surface) { write_points(surface, file); });
  return std::fclose(file) == 0 ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "contraction: %s\n", e.what());
  return 1;
}
