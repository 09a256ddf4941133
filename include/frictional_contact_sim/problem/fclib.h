#pragma once
/**
 * @file fclib.h
 * @brief Problems, guesses and solutions in the field's exchange format, FCLib (HDF5). The one place of sign
 * conventions.
 *
 *   FCLib global   M v = H_f r + G_f lambda + f_f,  u = H_f^T v + w,  G_f^T v + b = 0
 *   ours           H = H_f^T,  G = G_f^T,  f = -f_f
 *   FCLib local    u = W r + V lambda + q,  V^T r + R lambda + s = 0
 *   ours           W <- [W V; V^T R], q <- (q, s), the rows of s as BILATERAL laws behind the contacts
 *
 * Reading: with the HDF5 library alone, because libfclib ends the process on a broken file; it writes. Every defect is
 * one std::runtime_error line: file, what was found, what was expected. Triplet matrices have i = rows and p = columns,
 * as CSparse and the files do, whatever fclib.h's comment says. Rolling problems are refused.
 *
 * Writing: FCLib knows Coulomb contacts of one dimension only. The others are encoded exactly:
 *   COULOMB_2D among 3D contacts   second tangential row zero
 *   UNILATERAL                     mu = 0, tangential rows zero
 *   DRY_FRICTION                   mu = 1, first tangential row = the row; the normal row acts on one extra
 *                                  velocity a of mass m with  m a + c = r_N, u_N = a: only a = 0, r_N = c solves that
 *   BILATERAL rows                 moved to G (global) or to V, R, s (local)
 *
 * The extra velocities follow the others, moved rows follow those of G; a description should say so (info).
 *
 * What a simulation knows of the rows' velocities (LawScale) stands in a group of its own, /frictional_contact_sim,
 * that other readers skip: law_scales and bilateral_scales, a row (unit, reach, speed change, speed) each. So a dumped
 * step is judged as in the simulation. Local problems with BILATERAL laws are written without.
 *
 * Threads may call these at the same time: HDF5 is used by one of them at a time.
 *
 * Source: Acary et al. (2014), "FCLIB: a collection of discrete 3D frictional contact problems".
 */
#include <optional>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/delassus_problem.h"
#include "frictional_contact_sim/problem/incremental_problem.h"

namespace frictional_contact_sim
{
enum class FclibKind
{
  LOCAL,
  GLOBAL
};

/** @brief The texts of FCLib's info group. */
struct FclibInfo
{
  std::string title;
  std::string description;
  std::string math_info;
};

/** @brief A file's content; `local` or `global` is filled according to `kind`. */
struct FclibProblem
{
  FclibKind kind = FclibKind::LOCAL;
  int dimension = 3;  ///< 2 or 3
  int contacts = 0;
  DelassusProblem local;
  IncrementalProblem global;
  FclibInfo info;
  std::optional<Solution> solution;  ///< what the dumping program stored; often not converged
  std::vector<Solution> guesses;
};

/** @throws std::runtime_error in one line when the file cannot be used. */
FclibProblem readFclib(const std::string& path);

/**
 * @brief Writes a problem, and a solution when given; replaces an existing file at once (written beside, then renamed).
 * @throws std::runtime_error when it cannot be written
 */
void writeFclib(const std::string& path, const IncrementalProblem& problem, const FclibInfo& info,
                const Solution* solution = nullptr);
void writeFclib(const std::string& path, const DelassusProblem& problem, const FclibInfo& info,
                const Solution* solution = nullptr);

}  // namespace frictional_contact_sim
