#ifndef PLUMBLINE_FACTORS_GEMAN_MCCLURE_LOSS_H_
#define PLUMBLINE_FACTORS_GEMAN_MCCLURE_LOSS_H_

#include <ceres/loss_function.h>

#include "plumbline/factors/robust_loss.h"

namespace plumbline {

/// GemanMcClure as Ceres takes it. Apart from it, since few need to read Ceres' header.
class GemanMcClureLoss final : public ceres::LossFunction {
 public:
  explicit GemanMcClureLoss(const GemanMcClure& loss) : loss_(loss) {}

  void Evaluate(double s, double rho[3]) const override {
    rho[0] = loss_.Rho(s);
    rho[1] = loss_.Weight(s);
    rho[2] = loss_.Curvature(s);
  }

 private:
  GemanMcClure loss_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_GEMAN_MCCLURE_LOSS_H_
