#pragma once
/**
 * @file markers.h
 * @brief Contacts as rviz markers: an arrow for each force (namespace `force`), and the friction cones at the contacts
 * (namespace `cone`), coloured by mode: sticking green, sliding orange, impact blue, open grey.
 */
#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>

#include "frictional_contact_sim/simulation/simulator.h"

namespace frictional_contact_sim
{
/** @brief Half a metre for the weight of all bodies; 0.01 m/N where there is no weight. */
double defaultForceScale(const Simulator& simulator);

/**
 * @param force_scale length of arrows [m/N]
 * @param previous_arrows arrows in the message before this one: those that are gone are deleted
 * @return arrows in this message
 */
size_t fillMarkers(const Simulator& simulator, const ros::Time& stamp, double force_scale, size_t previous_arrows,
                   visualization_msgs::MarkerArray& message);

}  // namespace frictional_contact_sim
