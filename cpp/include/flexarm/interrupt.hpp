/// @file
/// How a long computation learns that it shall end, where no caller's progress is told.
#pragma once

namespace flexarm {

/// Throws if the computation shall end; called from the thread that computes.
using InterruptCheck = void (*)();

/// Sets what check_interrupt() calls; null: nothing.
void set_interrupt_check(InterruptCheck check);

/// Calls the check, at most fifty times a second in each thread.
void check_interrupt();

}  // namespace flexarm
