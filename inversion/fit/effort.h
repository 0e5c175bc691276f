// How far a fit by Levenberg-Marquardt goes on, and by how much of the views.
#pragma once

#include "inversion/solve/bias_free.h"

namespace inversion {

struct Effort {
  int block_stride = 1;  // ViewObjective
  bool rounds = true;    // false: the steps, if the options allow them, begin at the first start
  bool robust = true;    // false: no robust weights, whatever the options say
  int approach_steps = BiasFreeOptions{}.approach_steps;  // of bias_free.h, as the next
  int joint_steps = BiasFreeOptions{}.joint_steps;
  bool by_whole_hessian = false;  // JoinedSets::whole_hessian
};

// With fewer paths the product of two halves' errors is larger than the bias that those steps are to remove.
inline constexpr int kFewestPathsWithoutBias = 512;

}  // namespace inversion
