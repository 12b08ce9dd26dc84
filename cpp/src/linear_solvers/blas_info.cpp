#include "flexarm/linear_solvers/blas_info.hpp"

#if defined(FLEXARM_HAS_CHOLMOD) && __has_include(<dlfcn.h>)
#include <cholmod.h>
#include <dlfcn.h>
#include <pthread.h>
#endif

namespace flexarm::linear_solvers {

#if defined(FLEXARM_HAS_CHOLMOD) && __has_include(<dlfcn.h>)

namespace {

/// Address of `name` among what CHOLMOD's own library depends on: NumPy brings another OpenBLAS into the same
/// process, which CHOLMOD does not use.
void* symbol_of_cholmod(const char* name) {
  Dl_info library;
  if (dladdr(reinterpret_cast<void*>(&cholmod_start), &library) == 0) return nullptr;
  void* handle = dlopen(library.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
  if (handle == nullptr) handle = dlopen(nullptr, RTLD_LAZY);  // linked into the program itself
  void* address = handle == nullptr ? nullptr : dlsym(handle, name);
  if (handle != nullptr) dlclose(handle);
  return address;
}

using SetCount = void (*)(int);
SetCount set_max_active_levels = nullptr;  // of OpenMP; found before the fork, after which a lock may be held

/// In the child of a fork.
void run_in_one_thread() {
  if (set_max_active_levels != nullptr) set_max_active_levels(0);
}

SetCount set_blas_threads() {
  static const auto set = reinterpret_cast<SetCount>(symbol_of_cholmod("openblas_set_num_threads"));
  return set;
}

std::string file_of(void* address) {
  Dl_info library;
  return address != nullptr && dladdr(address, &library) != 0 ? library.dli_fname : "unknown";
}

}  // namespace

void* blas_symbol(const std::string& name) { return symbol_of_cholmod(name.c_str()); }

std::string loaded_blas() {
  using Describe = char* (*)();
  if (auto* openblas = reinterpret_cast<Describe>(symbol_of_cholmod("openblas_get_config"))) {
    return openblas();
  }
  return file_of(symbol_of_cholmod("dgemm_"));
}

OneBlasThread::OneBlasThread() {
  static auto* const count = reinterpret_cast<int (*)()>(symbol_of_cholmod("openblas_get_num_threads"));
  if (count == nullptr || set_blas_threads() == nullptr || count() == 1) return;
  before_ = count();
  set_blas_threads()(1);
}

OneBlasThread::~OneBlasThread() {
  if (before_ > 0) set_blas_threads()(before_);
}

void survive_forks() {
  [[maybe_unused]] static const int registered = [] {
    set_max_active_levels = reinterpret_cast<SetCount>(symbol_of_cholmod("omp_set_max_active_levels"));
    return pthread_atfork(nullptr, nullptr, &run_in_one_thread);
  }();
}

#else

void* blas_symbol(const std::string&) { return nullptr; }
OneBlasThread::OneBlasThread() = default;
OneBlasThread::~OneBlasThread() = default;
std::string loaded_blas() { return "none, Eigen's own kernels"; }
void survive_forks() {}

#endif

}  // namespace flexarm::linear_solvers
