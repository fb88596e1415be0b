// Caches test results for the tiles of instances while they remain valid along a camera path.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <darboux/scene.h>

#include "surface_tiles.h"
#include "tile_culling.h"

namespace darboux {

// Prefetches what will be read soon.
inline void prefetch(const void* first, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; i += 64) __builtin_prefetch(static_cast<const char*>(first) + i);
}

// The accumulated motion of a camera: the path length of its position, and that of its matrix of axes. A
// rotation by the angle a moves a unit vector by at most 2 sin(a/2), and the matrix by √2 times that. Each
// step is rounded up, so that no motion is lost on a long path.
class CameraWay {
 public:
  double moved = 0, turned = 0;

  // Whether the camera continues the path of the last one; if not, the path starts again.
  bool goes_on(const Camera& next);

 private:
  std::optional<Camera> last_;
};

// Caches the answers of TileCulling. The answers for an instance are valid until the camera path exceeds the
// smallest of their limits; then those whose own limit is exceeded are computed again.
class KeptAnswers {
 public:
  // \param keeps answers from one camera to the next
  KeptAnswers(TileCulling& tests, bool keeps) : tests_(tests), keeps_(keeps) {}

  // Sets the next camera. Returns whether cached answers may be used.
  bool go_to(const Camera& camera, std::size_t instances);
  // Drops all answers.
  void forget();

  // Whether all answers of an instance are known to be still valid.
  bool hold(std::uint32_t instance) const {
    const Kept& k = kept_[instance];
    return way_.moved <= k.moving && way_.moved + k.reach * way_.turned <= k.turning;
  }
  // Prefetches the cached answers of an instance.
  void prefetch(std::uint32_t instance) const {
    darboux::prefetch(answers_.data() + kept_[instance].first, kept_[instance].count * sizeof(Answer));
  }

  // Selects the instance for the following questions. \throws ParameterError as TileCulling::begin()
  void begin(std::uint32_t instance, SurfaceTiles& tiles);
  // Computes again the answers that may have changed. Returns whether none did.
  bool still_hold();
  // Starts new answers: those computed until finish() replace the old answers of the instance.
  void start();
  void finish();

  // As those of TileCulling.
  bool outside(std::uint32_t node, std::uint8_t& planes) {
    return keeps_ ? ask_outside(node, planes) : tests_.outside(node, planes);
  }
  bool faces_away(std::uint32_t node) {
    return keeps_ ? ask(Question::faces_away, node) != 0 : tests_.faces_away(node);
  }
  Resolution resolution(std::uint32_t node) {
    return keeps_ ? ask_resolution(node) : tests_.resolution(node);
  }

 private:
  enum class Question : std::uint8_t { outside, faces_away, resolution };
  // An answer about a tile, and the camera path length up to which it is valid.
  struct Answer {
    double limit;
    std::uint32_t node;
    Question question;
    std::uint8_t planes;  // for which it was asked
    std::uint16_t value;
  };
  // The answers of an instance. All are valid while moved <= moving and moved + reach · turned <= turning.
  struct Kept {
    std::size_t first = 0;
    std::uint32_t count = 0;
    double reach = 0, moving = -std::numeric_limits<double>::infinity(), turning = moving;

    void lower(bool by_turning, double limit) {
      double& least = by_turning ? turning : moving;
      least = limit < least ? limit : least;
    }
  };

  // The camera path length up to which an answer is valid.
  double limit(double slack, bool turning) const;
  bool counts_turning(Question question) const {
    return question != Question::faces_away || !tests_.perspective();
  }
  std::uint16_t value(Question question, std::uint32_t node, std::uint8_t planes);
  Answer answer(Question question, std::uint32_t node, std::uint8_t planes);
  // Computes and stores an answer.
  std::uint16_t ask(Question question, std::uint32_t node, std::uint8_t planes = 0);
  bool ask_outside(std::uint32_t node, std::uint8_t& planes);
  Resolution ask_resolution(std::uint32_t node);
  void drop_old();

  TileCulling& tests_;
  bool keeps_;
  CameraWay way_;
  std::vector<Kept> kept_;  // of all instances
  std::vector<Answer> answers_;
  std::size_t dropped_ = 0;  // of these
  // Of the current instance.
  std::uint32_t instance_ = 0;
  Slack slack_of_whole_;
  double reach_ = 0;
  std::size_t first_ = 0;
};

}  // namespace darboux
