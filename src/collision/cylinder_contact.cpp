#include "frictional_contact_sim/collision/narrow_phase.h"
namespace frictional_contact_sim
{
void collideCylinder(const ConvexShape&, const ConvexShape&, const Eigen::Isometry3d&, double, Manifold&)
{
}
}  // namespace frictional_contact_sim
