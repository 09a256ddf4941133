#pragma once
/**
 * @file fclib_check.h
 * @brief Structure check of an FCLib file through the HDF5 library, and plain reading of its vectors. Internal.
 */
#include <hdf5.h>

#include <mutex>
#include <string>
#include <vector>

#include "frictional_contact_sim/problem/fclib.h"

namespace frictional_contact_sim
{
/** @brief Closes an HDF5 identifier at the end of its scope. */
class H5Handle
{
public:
  H5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~H5Handle()
  {
    if (id_ >= 0)
      close_(id_);
  }
  H5Handle(const H5Handle&) = delete;
  H5Handle& operator=(const H5Handle&) = delete;
  hid_t id() const { return id_; }
  bool valid() const { return id_ >= 0; }

private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/**
 * @brief HDF5 and libfclib, which threads must not use at once, are this scope's while it lives; HDF5's own printing is
 * silent.
 */
class H5Session
{
public:
  H5Session();
  ~H5Session();
  H5Session(const H5Session&) = delete;
  H5Session& operator=(const H5Session&) = delete;

private:
  std::lock_guard<std::mutex> lock_;
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/** @brief Sizes a checked file is known to have. */
struct FclibShape
{
  FclibKind kind = FclibKind::LOCAL;
  int dimension = 3;
  int velocities = 0, rows = 0, bilaterals = 0;
  bool has_solution = false;
  int guesses = 0;
};

/** @brief A stored matrix as CSparse has it: triplets (nz >= 0), compressed columns (-1) or compressed rows (-2). */
struct FclibMatrix
{
  int rows = 0, columns = 0, nz = 0;
  std::vector<int> p;  ///< triplets: column indices (see fclib.h); else pointers
  std::vector<int> i;
  std::vector<double> x;
};

/** @brief Checks everything that is read later. @throws std::runtime_error in one line. */
FclibShape checkFclib(const std::string& path);

/** @brief Reads parts of a checked file. libfclib is not asked: it ends the process on what it cannot read. */
FclibMatrix readMatrix(const std::string& path, const std::string& group);
Eigen::VectorXd readNumbers(const std::string& path, const std::string& dataset);
/** @param root "/fclib_local" or "/fclib_global" */
FclibInfo readInfo(const std::string& path, const std::string& root);

/** @brief Reads the vectors of a solution group of a checked file; missing ones stay empty. */
Solution readSolutionGroup(const std::string& path, const std::string& group, const FclibShape& shape);

/// Where scales stand in a file, beside FCLib's own groups; readers that do not know them skip them.
constexpr const char* SCALES_GROUP = "/frictional_contact_sim";
constexpr const char* LAW_SCALES = "/frictional_contact_sim/law_scales";
constexpr const char* BILATERAL_SCALES = "/frictional_contact_sim/bilateral_scales";
/// Numbers of a scale: unit (0 length, 1 angle, 2 slack), reach, speed change, speed.
constexpr int SCALE_NUMBERS = 4;

/** @brief Reads scales of a checked file; empty where there are none. @throws std::runtime_error in one line. */
std::vector<LawScale> readScales(const std::string& path, const char* dataset, int count);

/** @brief Adds scales to a file; false when it cannot. Nothing is written of none. */
bool writeScales(const std::string& path, const std::vector<LawScale>& laws, const std::vector<LawScale>& bilaterals);

}  // namespace frictional_contact_sim
