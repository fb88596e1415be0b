#include "kept_answers.h"

#include <algorithm>
#include <span>
#include <utility>

namespace darboux {
namespace {

constexpr std::uint8_t all_planes = 63;  // of the frustum

}  // namespace

bool CameraWay::goes_on(const Camera& next) {
  const bool same = last_ && last_->projection == next.projection && last_->width_px == next.width_px &&
                    last_->height_px == next.height_px &&
                    last_->vertical_field_of_view_rad == next.vertical_field_of_view_rad &&
                    last_->view_height == next.view_height && last_->near_distance == next.near_distance &&
                    last_->far_distance == next.far_distance;
  if (!same) {
    moved = turned = 0;
  } else if (next.pose.matrix() != last_->pose.matrix()) {
    constexpr double up = 1 + 0x1p-50;
    moved = (moved + (next.pose.translation() - last_->pose.translation()).norm() * (1 + 0x1p-48)) * up;
    // Poses are rigid to 1e-5.
    turned = (turned + (next.pose.linear() - last_->pose.linear()).norm() * (1 + 0x1p-15)) * up;
  }
  last_ = next;
  return same;
}

bool KeptAnswers::go_to(const Camera& camera, std::size_t instances) {
  tests_.look(camera);
  const bool goes_on = way_.goes_on(camera);
  if (!goes_on) forget();
  if (keeps_) {
    drop_old();
    kept_.resize(instances);
  }
  return goes_on;
}

void KeptAnswers::forget() {
  std::fill(kept_.begin(), kept_.end(), Kept());
  answers_.clear();
  dropped_ = 0;
}

void KeptAnswers::begin(std::uint32_t instance, SurfaceTiles& tiles) {
  instance_ = instance;
  tests_.begin(instance, tiles);
  slack_of_whole_ = tests_.slack;
}

bool KeptAnswers::still_hold() {
  Kept& k = kept_[instance_];
  if (k.reach == 0 || !(tests_.placed().farthest < k.reach)) return false;
  reach_ = k.reach;
  k.moving = limit(slack_of_whole_.moving, false);
  k.turning = limit(slack_of_whole_.turning, true);
  for (Answer& known : std::span(answers_).subspan(k.first, k.count)) {
    const bool turning = counts_turning(known.question);
    if (!(way_.moved + (turning ? reach_ * way_.turned : 0) <= known.limit)) {
      const Answer now = answer(known.question, known.node, known.planes);
      if (now.value != known.value) return false;
      known = now;
    }
    k.lower(turning, known.limit);
  }
  return true;
}

void KeptAnswers::start() {
  if (!keeps_) return;
  reach_ = 1.25 * tests_.placed().farthest;
  first_ = answers_.size();
}

void KeptAnswers::finish() {
  if (!keeps_) return;
  Kept& old = kept_[instance_];
  Kept k{first_, static_cast<std::uint32_t>(answers_.size() - first_), reach_,
         limit(slack_of_whole_.moving, false), limit(slack_of_whole_.turning, true)};
  for (const Answer& a : std::span(answers_).subspan(first_)) k.lower(counts_turning(a.question), a.limit);
  // Reuses the space of the old ones, if it is large enough.
  dropped_ += old.count;
  if (k.count > 0 && k.count <= old.count) {
    std::copy(answers_.begin() + static_cast<std::ptrdiff_t>(first_), answers_.end(),
              answers_.begin() + static_cast<std::ptrdiff_t>(old.first));
    answers_.resize(first_);
    k.first = old.first;
    dropped_ -= k.count;
  }
  old = k;
}

void KeptAnswers::drop_old() {
  if (2 * dropped_ <= answers_.size()) return;
  std::vector<Answer> left;
  left.reserve(answers_.size() - dropped_);
  for (Kept& k : kept_) {
    const auto of_it = std::span(answers_).subspan(k.first, k.count);
    k.first = left.size();
    left.insert(left.end(), of_it.begin(), of_it.end());
  }
  answers_ = std::move(left);
  dropped_ = 0;
}

double KeptAnswers::limit(double slack, bool turning) const {
  const double way = way_.moved + (turning ? reach_ * way_.turned : 0),
               certain = slack - tests_.rounding() - 0x1p-40 * way;
  return way + std::min(std::max(certain, 0.0), std::max(reach_ - tests_.placed().farthest, 0.0));
}

std::uint16_t KeptAnswers::value(Question question, std::uint32_t node, std::uint8_t planes) {
  if (question == Question::outside) {
    const bool outside = tests_.outside(node, planes);
    return static_cast<std::uint16_t>(outside ? all_planes + 1 : planes);
  }
  if (question == Question::faces_away) return tests_.faces_away(node);
  const Resolution r = tests_.resolution(node);
  return static_cast<std::uint16_t>(r.cells.u | r.cells.v << 4 | r.proven.chord << 8 | r.proven.frame << 9);
}

KeptAnswers::Answer KeptAnswers::answer(Question question, std::uint32_t node, std::uint8_t planes) {
  tests_.slack = {};
  const std::uint16_t x = value(question, node, planes);
  const bool turning = counts_turning(question);
  return {limit(turning ? tests_.slack.turning : tests_.slack.moving, turning), node, question, planes, x};
}

std::uint16_t KeptAnswers::ask(Question question, std::uint32_t node, std::uint8_t planes) {
  answers_.push_back(answer(question, node, planes));
  return answers_.back().value;
}

bool KeptAnswers::ask_outside(std::uint32_t node, std::uint8_t& planes) {
  const std::uint16_t left = ask(Question::outside, node, planes);
  if (left > all_planes) return true;
  planes = static_cast<std::uint8_t>(left);
  return false;
}

Resolution KeptAnswers::ask_resolution(std::uint32_t node) {
  const int x = ask(Question::resolution, node);
  return {{x & 15, x >> 4 & 15}, {(x >> 8 & 1) != 0, (x >> 9 & 1) != 0}};
}

}  // namespace darboux
