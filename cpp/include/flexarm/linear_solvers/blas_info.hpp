/// @file
/// Which BLAS the loaded libraries call: it decides how fast CHOLMOD factors, and no compiler knows it, since
/// the system may exchange it under a finished build.
#pragma once

#include <string>

namespace flexarm::linear_solvers {

/// For instance "OpenBLAS 0.3.21 ..."; the file of the library where it does not tell its name; "none" where
/// the build calls no BLAS.
std::string loaded_blas();

/// Address of a function of that BLAS, for instance "dgemm_"; null where there is none.
void* blas_symbol(const std::string& name);

/// Leaves one thread to that BLAS while it lives, where it is OpenBLAS. Functions of LAPACK that multiply by
/// vectors wait for all threads at each column; on a busy machine every wait takes a turn of all other
/// processes.
class OneBlasThread {
 public:
  OneBlasThread();
  ~OneBlasThread();
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  int before_ = 0;  ///< threads to return to; 0 where none were taken away
};

/// Lets processes that are forked from now on use CHOLMOD. OpenMP's threads do not come along into them, and
/// its parallel regions would wait for them for ever; there they run in one thread.
void survive_forks();

}  // namespace flexarm::linear_solvers
