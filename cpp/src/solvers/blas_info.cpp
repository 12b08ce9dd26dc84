#include "flexarm/solvers/blas_info.hpp"

#if defined(FLEXARM_HAS_CHOLMOD) && __has_include(<dlfcn.h>)
#include <cholmod.h>
#include <dlfcn.h>
#endif

namespace flexarm::solvers {

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

std::string file_of(void* address) {
  Dl_info library;
  return address != nullptr && dladdr(address, &library) != 0 ? library.dli_fname : "unknown";
}

}  // namespace

std::string loaded_blas() {
  using Describe = char* (*)();
  if (auto* openblas = reinterpret_cast<Describe>(symbol_of_cholmod("openblas_get_config"))) {
    return openblas();
  }
  return file_of(symbol_of_cholmod("dgemm_"));
}

#elif defined(FLEXARM_HAS_CHOLMOD)

std::string loaded_blas() { return "unknown"; }

#else

std::string loaded_blas() { return "none, Eigen's own kernels"; }

#endif

}  // namespace flexarm::solvers
