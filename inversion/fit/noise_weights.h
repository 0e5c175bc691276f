// Weights of residuals by how noisy they are. The variances that light paths leave in the residuals of eq. 6 differ by
// factors of a million, as the few bright blocks of views against the light and near the mirror direction have nearly
// all of it: what quiet blocks say would be drowned. The best weights of residuals r with a noise of variance v and a
// misfit of variance m^2 that no unknowns remove are 1 / (v + m^2). Eq. 6 is their limit for a misfit alike
// everywhere that is above the noise; where the model explains the views, m^2 goes to 0 and each residual counts by
// what it knows.
//
// The noise is estimated from other paths than those that are weighted, because a block whose paths happen to miss the
// light looks dark and quiet at once. m^2 is the larger of two estimates: by products of residuals of two halves of the
// paths, weighted by 1 / (v + m^2)^2 themselves, and the least that eq. 6's own sum leaves certain, three of its
// deviations below it. Of two sets of paths the smaller m^2 counts: what a bad step adds is gone with the next one.
//
// Sets are told by the noise that they have where they are traced: in narrow lobes it is a hundred times as large as in
// wide ones, and there a set must count so much less, or a search that noise has led there never comes back.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace inversion {

class NoiseWeights {
 public:
  // groups: the number of each residual's view and colour, from 0. Few paths carry most of a block's variance and many
  // sets miss them, so that the variance is the mean over a group.
  // Of the variances of the sets before a set counts `old` times what it did.
  explicit NoiseWeights(std::vector<int> groups, double old = 1) : groups_(std::move(groups)), old_(old) {}

  // From one set of paths, in eq. 6's units: the variance of each residual, and the product of its two halves less the
  // photographs' part of that variance, which both halves share.
  void add(const Eigen::VectorXd& variances, const Eigen::VectorXd& products);
  bool empty() const { return sets_ == 0; }
  double misfit_variance() const { return misfit_; }  // m^2
  double weighted_variance() const;                   // of the residuals times their factors
  // The part of it that is alike in all sets of paths: the misfit and the noise of the photographs, whose part of each
  // variance is given.
  double variance_alike(const Eigen::VectorXd& photographs) const;
  // What eq. 6's residuals are multiplied by: sqrt(r mean(v + m^2) / (v + m^2)), r being the mean of v after the first
  // set over that now. It needs at least one set.
  Eigen::VectorXd factors() const;

 private:
  Eigen::VectorXd mean_of_groups(const Eigen::VectorXd& values) const;
  double misfit_of(const Eigen::VectorXd& products) const;

  std::vector<int> groups_;
  double old_, sets_ = 0, first_ = 0;
  double misfit_ = 0, last_misfit_ = 0;
  Eigen::VectorXd variances_;  // mean of the sets, the older ones fading, and of the residual's group
};

}  // namespace inversion
