#pragma once
/**
 * @file cut_study.h
 * @brief One round of cuts on an integer program, compared as in section 7.4: (i) the most violated cut, (ii) the
 * deepest one, (iii) the facet cuts that it is made of.
 *
 * The split is x_j <= floor, x_j >= floor + 1 of the most fractional variable at the vertex of the relaxation; rows
 * have length one, the vertex is the origin, and with equations the space is their null space (lin Q, footnote
 * of 7.3.1). A cut is added with its right-hand side from the support function of the disjunction, so that it is valid
 * whatever the digits of its direction.
 *
 * Source: Cadoux (2009), sections 7.3.5, 7.4.
 */
#include "frictional_contact_sim/separation/facet_decomposition.h"
#include "frictional_contact_sim/separation/integer_program.h"

namespace frictional_contact_sim
{
/** @brief row.x <= right_hand_side, in the program's own coordinates. */
struct StudiedCut
{
  Eigen::VectorXd row;
  double right_hand_side = 0.0;
  double depth = 0.0;  ///< distance of the vertex from the hyperplane, within E x = e
  double weight = 1.0;  ///< in the deepest cut
  bool is_ray = false;  ///< of Q^-: touches Q, but need not cut the vertex off
  bool on_bound = false;  ///< extreme by the bound N only
  int face_dimension = -1;  ///< of the face of Q that it exposes; -1: not asked
};

enum class StudyStatus
{
  STUDIED,
  WHOLE,  ///< the relaxation's vertex fulfils the integrality: nothing to cut
  INFEASIBLE,  ///< the relaxation, or both sides of the split: no whole point at all
  UNBOUNDED,  ///< the relaxation
  FAILED  ///< message says why
};

struct StudyOptions
{
  DecompositionOptions decomposition;
  Normalisation normalisation = Normalisation::MULTIPLIERS;  ///< of the most violated cut
  bool check_facets = false;  ///< dimensions of the faces, 2 n linear programs a cut
};

struct CutStudy
{
  StudyStatus status = StudyStatus::FAILED;
  std::string message;
  Eigen::VectorXd vertex;
  int variable = -1;  ///< j of the split
  double relaxed = 0.0;  ///< cost of the relaxation (7.12)
  StudiedCut most_violated, deepest;
  std::vector<StudiedCut> facets;
  double with_most_violated = 0.0, with_deepest = 0.0,
         with_facets = 0.0;  ///< cost with those cuts; infinite: none is left
  int calls = 0;  ///< of the oracle
  double bound = 0.0;  ///< N of (7.27), 0: none
  double duality_error = 0.0;  ///< | |d| |q| - 1 |, q the projection on Q by itself (6.10)
  int dimension = -1;  ///< of Q; -1: not asked
  std::vector<double> norms;  ///< |d_k|
};

CutStudy studyCuts(const IntegerProgram& program, const StudyOptions& options = {});

}  // namespace frictional_contact_sim
