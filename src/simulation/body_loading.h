#pragma once
/**
 * @file body_loading.h
 * @brief A body of a scenario from its description to its place in the world, in three calls. Private to simulation/.
 *
 * All throw ModelError or std::invalid_argument with one line that names the body and what is wrong.
 */
#include <string>
#include <vector>

#include "frictional_contact_sim/simulation/world_model.h"

namespace frictional_contact_sim
{
/** A body while it is loaded. */
struct Draft
{
  BodyModel& model;
  BodyState& state;
};

BodyModel loadBody(const BodySpec& spec, std::vector<std::string>& warnings);

/** Joints, base pose and velocities. */
void setInitialState(const BodySpec& spec, const Draft& body, std::vector<std::string>& warnings);

/** The base moves from its pose on, along `motion`: where a program says, from the start. */
void startMotion(const BaseMotion& motion, const Draft& body);

/** Adds the body's shapes, puts it on the ground where no pose is given, and gives it commands and wrenches. */
void placeBody(const BodySpec& spec, const Draft& body, WorldModel& world);

}  // namespace frictional_contact_sim
