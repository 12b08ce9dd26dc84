#include "flexarm/lanes/kernel_code.hpp"

namespace flexarm::lanes {

struct Avx2;
extern const Kernel kernel_avx2 = KernelCode<4, Avx2>::kernel;

}  // namespace flexarm::lanes
