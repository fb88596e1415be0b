// What is asked about the tiles of instances, and for how long the answers stay the same on a camera's way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <darboux/scene.h>

#include "surface_tiles.h"
#include "tile_tests.h"

namespace darboux {

// Prefetches what will be read soon.
inline void prefetch(const void* first, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; i += 64) __builtin_prefetch(static_cast<const char*>(first) + i);
}

// How far a camera has moved and turned, all in all: the length of its way, and that of its axes' way as a
// matrix: a turn by the angle a moves no unit vector by more than 2 sin(a/2), and the matrix by √2 times
// that. Each step adds more than is rounded, so that none is lost in a long way.
class CameraWay {
 public:
  double moved = 0, turned = 0;

  // Whether it goes on from the last camera; else the way begins anew.
  bool goes_on(const Camera& next);

 private:
  std::optional<Camera> last_;
};

// The answers of TileTests. Where they are kept, those of an instance hold until the camera's way is longer
// than the least of their limits; then each whose own limit is passed is asked for again.
class KeptAnswers {
 public:
  // \param keeps answers from one camera to the next
  KeptAnswers(TileTests& tests, bool keeps) : tests_(tests), keeps_(keeps) {}

  // The next camera. Whether what was kept counts for it.
  bool go_to(const Camera& camera, std::size_t instances);
  // Drops all answers.
  void forget();

  // Whether all answers of an instance are known to stay the same.
  bool hold(std::uint32_t instance) const {
    const Kept& k = kept_[instance];
    return way_.moved <= k.moving && way_.moved + k.reach * way_.turned <= k.turning;
  }
  // Fetches what is soon asked for again.
  void prefetch(std::uint32_t instance) const {
    darboux::prefetch(answers_.data() + kept_[instance].first, kept_[instance].count * sizeof(Answer));
  }

  // An instance, of which the next ones are asked. \throws ParameterError as TileTests::begin()
  void begin(std::uint32_t instance, SurfaceTiles& tiles);
  // Asks again what may have another answer by now. Whether none has.
  bool still_hold();
  // Asks anew: what is asked until finish() takes the place of the instance's old answers.
  void start();
  void finish();

  // As those of TileTests.
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
  // An answer about a tile, and how far the camera's way may go until it is another.
  struct Answer {
    double limit;
    std::uint32_t node;
    Question question;
    std::uint8_t planes;  // that were asked about
    std::uint16_t value;
  };
  // The answers of an instance. All stay the same while moved <= moving and moved + reach · turned <=
  // turning.
  struct Kept {
    std::size_t first = 0;
    std::uint32_t count = 0;
    double reach = 0, moving = -std::numeric_limits<double>::infinity(), turning = moving;

    void lower(bool by_turning, double limit) {
      double& least = by_turning ? turning : moving;
      least = limit < least ? limit : least;
    }
  };

  // How far the camera's way may go.
  double limit(double slack, bool turning) const;
  bool counts_turning(Question question) const {
    return question != Question::faces_away || !tests_.perspective();
  }
  std::uint16_t value(Question question, std::uint32_t node, std::uint8_t planes);
  Answer answer(Question question, std::uint32_t node, std::uint8_t planes);
  // Asks, and keeps the answer.
  std::uint16_t ask(Question question, std::uint32_t node, std::uint8_t planes = 0);
  bool ask_outside(std::uint32_t node, std::uint8_t& planes);
  Resolution ask_resolution(std::uint32_t node);
  void drop_old();

  TileTests& tests_;
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
