#include "flexarm/interrupt.hpp"

#include <atomic>
#include <chrono>

namespace flexarm {
namespace {

using Clock = std::chrono::steady_clock;

// The check takes the interpreter's lock, for which it may have to wait.
constexpr Clock::duration between_checks = std::chrono::milliseconds(20);

std::atomic<InterruptCheck> current = nullptr;

}  // namespace

void set_interrupt_check(InterruptCheck check) { current = check; }

void check_interrupt() {
  const InterruptCheck check = current;
  if (check == nullptr) return;
  thread_local Clock::time_point last;
  const auto now = Clock::now();
  if (now - last < between_checks) return;
  last = now;
  check();
}

}  // namespace flexarm
