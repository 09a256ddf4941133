#include "frictional_contact_sim/simulation/state_file.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "fnv1a.h"
#include "frictional_contact_sim/simulation/state_archive.h"

namespace frictional_contact_sim
{
namespace
{
const std::string MAGIC = "FCSSTATE";
constexpr std::uint64_t VERSION = 7;  ///< 2: wide contact ids, 3: welds, 4: settings, 5: loops, 6: wedged overlaps
constexpr size_t HEADER = 8 + 4 + 8 + 8;  ///< bytes

void append(std::string& bytes, std::uint64_t value, int width)
{
  for (int byte = 0; byte < width; ++byte)
    bytes.push_back(static_cast<char>((value >> (8 * byte)) & 0xffU));
}

std::uint64_t parse(const std::string& bytes, size_t at, int width)
{
  std::uint64_t value = 0;
  for (int byte = 0; byte < width; ++byte)
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[at + byte])) << (8 * byte);
  return value;
}

std::uint64_t checksum(const std::string& bytes)
{
  Fnv1a hash;
  for (const char byte : bytes)
    hash.add(static_cast<unsigned char>(byte));
  return hash.value();
}

class Writer : public StateArchive
{
public:
  void number(const std::string&, double& value) override
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    append(bytes, bits, 8);
  }
  void integer(const std::string&, std::uint64_t& value) override { append(bytes, value, 8); }
  void text(const std::string&, std::string& value) override
  {
    append(bytes, value.size(), 8);
    bytes += value;
  }
  std::string bytes;
};

class Reader : public StateArchive
{
public:
  explicit Reader(std::string payload) : bytes_(std::move(payload)) {}
  void number(const std::string& name, double& value) override
  {
    const std::uint64_t bits = take(name);
    std::memcpy(&value, &bits, sizeof bits);
    if (std::isnan(value))
      throw StateError(name + " is not a number");
  }
  void integer(const std::string& name, std::uint64_t& value) override { value = take(name); }
  void text(const std::string& name, std::string& value) override
  {
    const std::uint64_t length = take(name);
    if (length > bytes_.size() - at_)
      throw StateError(name + " is cut off");
    value = bytes_.substr(at_, length);
    at_ += length;
  }
  void expectEnd() const
  {
    if (at_ != bytes_.size())
      throw StateError(std::to_string(bytes_.size() - at_) + " bytes too many at the end");
  }

private:
  std::uint64_t take(const std::string& name)
  {
    if (bytes_.size() - at_ < 8)
      throw StateError(name + " is cut off");
    at_ += 8;
    return parse(bytes_, at_ - 8, 8);
  }

  std::string bytes_;
  size_t at_ = 0;
};

void expect(StateArchive& archive, const std::string& what, const std::string& expected)
{
  std::string found = expected;
  archive.text(what, found);
  if (found != expected)
    throw StateError(what + " is '" + found + "', expected '" + expected + "'");
}

void expect(StateArchive& archive, const std::string& what, int expected)
{
  int found = expected;
  archive.index(what, found);
  if (found != expected)
    throw StateError(what + " is " + std::to_string(found) + ", expected " + std::to_string(expected));
}

/** Names and sizes of the bodies: written, or compared with what a file has. */
void visitNames(StateArchive& archive, const Simulator& simulator)
{
  expect(archive, "number of bodies", simulator.bodyCount());
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const BodyModel& model = simulator.workspace(body).model;
    const MultibodyModel& tree = model.tree;
    const std::string name = "body " + std::to_string(body);
    expect(archive, "name of " + name, simulator.bodyName(body));
    expect(archive, "positions of " + name, model.nq);
    expect(archive, "velocities of " + name, model.nv);
    expect(archive, "joints of " + name, static_cast<int>(tree.joints.size()));
    for (const Joint& joint : tree.joints)
      expect(archive, "joint of " + name, joint.name);
  }
}

/** A device or a pipe may never end, and must not be renamed over. */
bool isOtherThanFile(const std::string& path)
{
  std::error_code error;
  return std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error);
}

std::string readPayload(const std::string& path)
{
  if (isOtherThanFile(path))
    throw StateError("is not a regular file");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw StateError("cannot be read");
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.compare(0, MAGIC.size(), MAGIC) != 0)
    throw StateError("does not begin with " + MAGIC + ", expected a file of ~save_state or run_scenario --save-state");
  if (bytes.size() < HEADER)
    throw StateError("is cut off in its header");
  const std::uint64_t version = parse(bytes, 8, 4);
  if (version != VERSION)
    throw StateError("has version " + std::to_string(version) + ", expected " + std::to_string(VERSION));
  const std::uint64_t length = parse(bytes, 12, 8);
  std::string payload = bytes.substr(HEADER);
  if (payload.size() != length)
    throw StateError("has " + std::to_string(payload.size()) + " bytes after its header, expected " +
                     std::to_string(length) + ": cut off, or not closed");
  if (checksum(payload) != parse(bytes, 20, 8))
    throw StateError("has been changed: its checksum is wrong");
  return payload;
}
}  // namespace

void saveState(const Simulator& simulator, const std::string& path)
{
  Writer writer;
  visitNames(writer, simulator);
  RunSettings settings = simulator.settings();
  visitSettings(writer, settings);
  SimulationState state = simulator.state();
  visitState(writer, state);
  std::string bytes = MAGIC;
  append(bytes, VERSION, 4);
  append(bytes, writer.bytes.size(), 8);
  append(bytes, checksum(writer.bytes), 8);
  bytes += writer.bytes;

  if (isOtherThanFile(path))
    throw StateError(path + ": cannot be written: it is not a regular file");
  const std::string part = path + ".part" + std::to_string(getpid());
  std::ofstream file(part, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file || std::rename(part.c_str(), path.c_str()) != 0)
  {
    std::remove(part.c_str());
    throw StateError(path + ": cannot be written: " + std::strerror(errno));
  }
}

SavedState readState(const Simulator& simulator, const std::string& path)
{
  try
  {
    Reader reader(readPayload(path));
    visitNames(reader, simulator);
    SavedState saved{simulator.state(), {}};
    visitSettings(reader, saved.settings);
    visitState(reader, saved.state);
    reader.expectEnd();
    return saved;
  }
  catch (const std::exception& error)
  {
    throw StateError(path + ": " + error.what());
  }
}

const StepOutcome& loadState(Simulator& simulator, const std::string& path)
{
  const SavedState saved = readState(simulator, path);
  try
  {
    return simulator.setState(saved.state, saved.settings);
  }
  catch (const std::exception& error)
  {
    throw StateError(path + ": " + error.what());
  }
}

}  // namespace frictional_contact_sim
