#pragma once
// Loops of a world: from what its URDFs and its scenario say, and a start that closes them.
#include "frictional_contact_sim/simulation/world_model.h"

namespace frictional_contact_sim
{
/** @brief Loops of the URDF of a body, added to world.loops. */
void addLoopsOfBody(int body, WorldModel& world);

/** @brief Loops of the scenario. @throws std::invalid_argument naming the loop and an unknown body or link, two links
 * that are one rigid thing, or two that cannot move */
void addLoopsOfScenario(WorldModel& world);

/**
 * @brief Moves joints of world.start until the loops from `first` on are closed: those without a position of their own
 * in the scenario, where that is not enough all, then floating bases too. What was moved is a warning, and so are rows
 * that say what others say already.
 * @throws std::invalid_argument naming a loop that no position closes, and by how much
 */
void closeLoops(WorldModel& world, size_t first = 0);

/** @brief The two links of a loop no longer collide, as those of a joint. Needs their shapes. */
void separate(const Closure& loop, WorldModel& world);

/** @brief After a body has gone: its loops go too, the others get the new numbers of their bodies. */
void removeLoopsOfBody(int body, WorldModel& world);

/** @brief After bodies without a pose were set on the ground: loops between them must still be closed.
 *  @throws std::invalid_argument naming the loop */
void checkLoops(const WorldModel& world);

}  // namespace frictional_contact_sim
