#pragma once
/**
 * @file elastic_overlap.h
 * @brief Bodies that are inside elastic ones, by cells and not by contacts: those know a node only down to a cell's
 * depth below the surface, and what is deeper would pass through. Private to simulation/.
 */
#include <string>
#include <vector>

#include "frictional_contact_sim/simulation/world_model.h"

namespace frictional_contact_sim
{
struct ElasticOverlap
{
  std::string line;  ///< both bodies and the depth
  bool is_let_out = true;  ///< shallow enough for contacts
};

/**
 * @brief For each pair of a body and an elastic one: how deep surface nodes, or centres of other shapes, are in its
 * cells. Less than a thousandth of a cell is a resting contact. Bodies without cells (matrices) have no inside.
 * @param states of the bodies
 * @param body that is one of the two; -1: any
 */
std::vector<ElasticOverlap> findElasticOverlaps(const WorldModel& world, const std::vector<BodyState>& states,
                                                int body = -1);

}  // namespace frictional_contact_sim
