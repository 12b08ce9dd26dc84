#include "flexarm/lanes/kernel_code.hpp"

namespace flexarm::lanes {

struct Avx512;
extern const Kernel kernel_avx512 = KernelCode<8, Avx512>::kernel;

}  // namespace flexarm::lanes
