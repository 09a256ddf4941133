#pragma once
// Linkages for tests: rods and hinges as URDF text, the four-bar that several tests turn, how far a loop is open.
#include <string>

#include "frictional_contact_sim/dynamics/closure.h"
#include "frictional_contact_sim/simulation/scenario.h"
#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** A rod of some length along x from its joint, no shapes; lengths [m], masses [kg]. */
std::string rodLink(const std::string& name, double length, double mass);

/** A continuous joint about y, `x` along the parent [m]. */
std::string hinge(const std::string& name, const std::string& parent, const std::string& child, double x);

struct FourBar
{
  double ground = 0.5, crank = 0.2, coupler = 0.45, rocker = 0.35;  // Grashof: the crank turns [m]
  double mass = 1.0;  // of the crank; the others are in proportion to their lengths [kg]
};

/** crank - coupler as one chain, rocker as another, closed by `loop` (an element, may be empty) where both meet. */
std::string fourBarUrdf(const FourBar& bar, const std::string& loop);
std::string loopElement(const FourBar& bar, const std::string& type);
/** On a fixed frame, 1 m above nothing, friction 0.5. */
Scenario fourBarScene(const FourBar& bar, const std::string& type, double crank_angle);

/** Where the two sides of a loop are apart [m]. */
double openness(const Simulator& simulator, const Closure& loop);

/** Kinetic and potential [J]. */
double energyOf(const Simulator& simulator);

}  // namespace frictional_contact_sim
