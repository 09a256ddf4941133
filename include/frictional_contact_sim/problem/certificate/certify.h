#pragma once
/**
 * @file certify.h
 * @brief The verdict on a whole problem: existence, its margin as a measure of conditioning, rank and condition, island
 * by island.
 *
 *   existence   REFUTED when one island is, CERTIFIED when all are, else UNDECIDED
 *   margin      the maximum of (3.37) over |v|_inf <= R, the least of all islands: how far w may move against every
 *               contact before the criterion is violated (Cadoux 2009, 3.5.2); of a verified v, so from below, and to
 *               ExistenceOptions::gap. 0 where the criterion holds without room
 *   blocking    REFUTED: laws that no velocity satisfies together
 *   limiting    laws that the least margin is attained at
 *
 * Every proof has been checked apart from who found it (problem/existence.h) before it is said.
 */
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/certificate/conditioning.h"
#include "frictional_contact_sim/problem/certificate/klarbring_pang.h"
#include "frictional_contact_sim/problem/existence.h"

namespace frictional_contact_sim
{
struct CertifyOptions
{
  double bound =
      0.0;  ///< R of the margin [unit of v]; 0: 1e3 |w| over the contacts' |H|, and twice the certificate's |v|
  bool margin = true;  ///< false: stop at the verdict; the margin is then that of the first certificate
  bool conditioning = true;  ///< rank and condition
  bool klarbring_pang = false;  ///< theorem 3.1 and (3.34) too
  int max_rows = 1500;  ///< of an island for rank and condition, >= 0
  ExistenceOptions existence;  ///< rounds, facets, gap; velocity_bound and maximise are set from the above

  /** @throws std::invalid_argument naming the field and its value. */
  void validate() const;
};

struct IslandCertificate
{
  std::vector<int> laws;  ///< of the whole problem
  std::vector<int> bilaterals;  ///< rows of G
  std::vector<int> velocities;  ///< of the whole problem; of a local one its rows
  ExistenceReport existence;  ///< v, multiplier in the island's own numbering; blocking in the whole problem's
  double margin = 0.0;  ///< of (3.37) [m/s]
  double upper_bound = 0.0;  ///< of that maximum [m/s]
  double bound = 0.0;  ///< the R used [unit of v]
  Conditioning conditioning;
  KlarbringPangReport klarbring_pang;  ///< when asked for
};

struct Certificate
{
  Existence existence = Existence::CERTIFIED;
  bool exact = true;  ///< see ExistenceReport
  double margin = 0.0;  ///< least of all islands [m/s]; 0 without any law
  double bound = 0.0;  ///< R of the island of that margin
  Eigen::VectorXd v;  ///< of all velocities (local problem: rows) when CERTIFIED: the proof
  Eigen::VectorXd multiplier;  ///< of all rows when REFUTED: the proof, with bilateral_multiplier
  Eigen::VectorXd bilateral_multiplier;  ///< rows of G
  std::vector<int> blocking;  ///< laws of the proof of REFUTED; else empty
  std::vector<int> blocking_bilaterals;  ///< rows of G of it
  std::vector<int> limiting;  ///< laws that bind at the maximum of the least margin, when it was asked for
  int rows = 0;  ///< of H without BILATERAL laws
  int rank = 0;  ///< of H, -1: not computed
  double condition = 0.0;  ///< largest of the islands' [-], 0: not computed or no rows
  bool unconditional = false;  ///< (3.34) in every island, when asked for
  std::vector<IslandCertificate> islands;
  std::string message;  ///< one line
  double seconds = 0.0;  ///< wall clock
};

/** @throws std::invalid_argument as validate(problem), and when M is not positive definite */
Certificate certify(const IncrementalProblem& problem, const CertifyOptions& options = {});
Certificate certify(const DelassusProblem& problem, const CertifyOptions& options = {});

}  // namespace frictional_contact_sim
