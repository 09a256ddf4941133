#pragma once
/**
 * @file row_sources.h
 * @brief The table of all kinds of rows.
 */
#include <memory>
#include <vector>

#include "frictional_contact_sim/dynamics/contact_set.h"
#include "frictional_contact_sim/dynamics/pair_table.h"
#include "frictional_contact_sim/dynamics/row_source.h"

namespace frictional_contact_sim
{
/**
 * @brief Every kind of row, in the order in which their rows stand at one joint and in which they are asked whether to
 * solve again. Names and sizes state.memory. All arguments outlive the sources.
 * @param contacts chooses the contact points; nullptr: those of the StepContext are taken as they are
 */
std::vector<std::unique_ptr<RowSource>> makeRowSources(std::vector<Body>& bodies, const CollisionWorld& world,
                                                       const PairTable& pairs, RowState& state,
                                                       ContactSet* contacts = nullptr);

}  // namespace frictional_contact_sim
