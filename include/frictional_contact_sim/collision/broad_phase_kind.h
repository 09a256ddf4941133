#pragma once
/**
 * @file broad_phase_kind.h
 * @brief Who looks for pairs of shapes that are near each other. The pairs found are the same, only the time differs.
 */
namespace frictional_contact_sim
{
enum class BroadPhaseKind
{
  AUTO,  ///< whichever is faster for the number of shapes, see broad_phase.cpp
  FCL,  ///< dynamic trees of axis-aligned boxes
  LIST  ///< every shape against every other
};
}  // namespace frictional_contact_sim
