#include "frictional_contact_sim/solver/convex/inner_solver.h"

#include <stdexcept>

#include "frictional_contact_sim/solver/convex/accelerated_gradient.h"
#include "frictional_contact_sim/solver/convex/convex_admm.h"
#include "frictional_contact_sim/solver/convex/convex_interior_point.h"
#include "frictional_contact_sim/solver/convex/projected_gradient.h"
#include "frictional_contact_sim/solver/convex/spectral_gradient.h"

namespace frictional_contact_sim
{
const std::vector<std::string>& innerSolverNames()
{
  static const std::vector<std::string> names = {"spectral_gradient", "projected_gradient", "accelerated_gradient",
                                                 "admm", "interior_point"};
  return names;
}

std::unique_ptr<ConvexSolver> createInnerSolver(InnerSolver which)
{
  switch (which)
  {
    case InnerSolver::SPECTRAL_GRADIENT:
      return std::make_unique<SpectralGradient>();
    case InnerSolver::PROJECTED_GRADIENT:
      return std::make_unique<ProjectedGradient>();
    case InnerSolver::ACCELERATED_GRADIENT:
      return std::make_unique<AcceleratedGradient>();
    case InnerSolver::ADMM:
      return std::make_unique<ConvexAdmm>();
    case InnerSolver::INTERIOR_POINT:
      return std::make_unique<ConvexInteriorPoint>();
  }
  throw std::invalid_argument("inner solver " + std::to_string(static_cast<int>(which)) + " does not exist");
}

}  // namespace frictional_contact_sim
