// Tells the thread sanitizer the order that a loop of tasks guarantees: oneTBB, which enforces it, is
// compiled without the sanitizer. Does nothing in other builds.
#pragma once

#include "sanitized.h"

#ifdef DARBOUX_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace darboux {

// Whatever precedes its construction happens before its tasks, and these before whatever follows its
// destruction.
class TaskOrder {
 public:
#ifdef DARBOUX_THREAD_SANITIZER
  TaskOrder() {
    __tsan_release(&begin_);
  }
  ~TaskOrder() {
    __tsan_acquire(&end_);
  }
  TaskOrder(const TaskOrder&) = delete;
  TaskOrder& operator=(const TaskOrder&) = delete;

  class Task {
   public:
    explicit Task(TaskOrder& order) : order_(order) { __tsan_acquire(&order_.begin_); }
    ~Task() { __tsan_release(&order_.end_); }
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

   private:
    TaskOrder& order_;
  };

 private:
  char begin_ = 0, end_ = 0;
#else
  struct Task {
    explicit Task(TaskOrder&) {}
  };
#endif
};

}  // namespace darboux
