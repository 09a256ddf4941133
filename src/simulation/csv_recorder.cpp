#include "frictional_contact_sim/simulation/csv_recorder.h"

#include <filesystem>
#include <stdexcept>

#include "frictional_contact_sim/simulation/body_document.h"
#include "frictional_contact_sim/simulation/root_motion.h"

namespace frictional_contact_sim
{
namespace
{
void write(std::ofstream& file, const Eigen::Vector3d& vector)
{
  file << ',' << vector.x() << ',' << vector.y() << ',' << vector.z();
}

/** As RFC 4180 has it: a path may hold anything. */
std::string quoted(const std::string& text)
{
  std::string result = "\"";
  for (const char letter : text)
    result += letter == '"' ? "\"\"" : std::string(1, letter);
  return result + "\"";
}
}  // namespace

std::ofstream CsvRecorder::open(const std::string& name, const char* columns) const
{
  const std::string path = folder_ + "/" + name;
  std::ofstream file(path);
  if (!file)
    throw std::runtime_error(path + ": cannot be written, expected a folder with write permission");
  file.precision(17);
  file << columns << '\n';
  return file;
}

CsvRecorder::CsvRecorder(const std::string& folder) : folder_(folder)
{
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw std::runtime_error(folder + ": cannot be created: " + error.message());
  states_ = open("states.csv", "time,body,x,y,z,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz");
  joints_ = open("joints.csv", "time,body,joint,position,velocity,effort");
  contacts_ =
      open("contacts.csv", "time,id,body_a,body_b,link_a,link_b,x,y,z,nx,ny,nz,gap,fx,fy,fz,vx,vy,vz,mode,friction");
  steps_ = open("steps.csv",
                "step,time,dt,contacts,velocities,bilaterals,islands,solver,solvers_tried,status,iterations,residual,"
                "solve_time,bilateral_violation,max_penetration,kinetic,potential,actuators,friction,impact,joints,"
                "balance_error,contact_rounds");
}

void CsvRecorder::recordBodies(const Simulator& simulator) const
{
  std::ofstream bodies = open("bodies.csv", "body,urdf,folder,height");
  std::error_code error;
  std::filesystem::create_directories(folder_ + "/bodies", error);
  if (error)
    throw std::runtime_error(folder_ + "/bodies: cannot be created: " + error.message());
  if (const std::optional<GroundSpec>& ground = simulator.scenario().ground)
    bodies << "ground,,," << ground->height << '\n';
  for (const BodySpec& body : simulator.scenario().bodies)
  {
    if (body.elastic)
      continue;
    const BodyDocument document = bodyDocument(body);
    const std::string name = "bodies/" + body.name + ".urdf";
    std::ofstream urdf(folder_ + "/" + name);
    urdf << document.urdf;
    urdf.close();
    if (!urdf)
      throw std::runtime_error(folder_ + "/" + name + ": cannot be written, is the disk full?");
    bodies << body.name << ',' << name << ',' << quoted(document.folder) << ",\n";
  }
}

void CsvRecorder::record(const Simulator& simulator, bool with_step)
{
  if (!knows_bodies_)
    recordBodies(simulator);
  knows_bodies_ = true;
  const double time = simulator.time();
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    const Eigen::Isometry3d pose = rootPose(simulator, body);
    const Eigen::Quaterniond orientation(pose.linear());
    const Vector6d velocity = rootVelocity(simulator, body);
    states_ << time << ',' << simulator.bodyName(body);
    write(states_, pose.translation());
    states_ << ',' << orientation.x() << ',' << orientation.y() << ',' << orientation.z() << ',' << orientation.w();
    write(states_, velocity.head<3>());
    write(states_, velocity.tail<3>());
    states_ << '\n';
    const MultibodyModel& model = simulator.model(body);
    for (size_t j = 0; j < model.joints.size(); ++j)
    {
      const Joint& joint = model.joints[j];
      if (velocitySize(joint.type) == 1)
        joints_ << time << ',' << simulator.bodyName(body) << ',' << joint.name << ','
                << simulator.position(body)[joint.q_index] << ',' << simulator.velocity(body)[joint.v_index] << ','
                << simulator.effort(body, static_cast<int>(j)) << '\n';
    }
  }
  recordNodes(simulator);
  if (!with_step)
    return;
  recordContacts(simulator);
  recordReport(simulator.report());
}

/** Surface nodes of deformable bodies. */
void CsvRecorder::recordNodes(const Simulator& simulator)
{
  for (int body = 0; body < simulator.bodyCount(); ++body)
  {
    if (!simulator.workspace(body).model.solid)
      continue;
    if (!nodes_.is_open())
      nodes_ = open("nodes.csv", "time,body,node,x,y,z,vx,vy,vz");
    const MultibodyData& data = simulator.data(body);
    for (size_t link = 1; link < data.link_pose.size(); ++link)
    {
      const std::string& name = simulator.model(body).links[link].name;
      nodes_ << simulator.time() << ',' << simulator.bodyName(body) << ',' << name.substr(name.find('_') + 1);
      write(nodes_, data.link_pose[link].translation());
      write(nodes_, data.link_velocity[link].head<3>());
      nodes_ << '\n';
    }
  }
}

void CsvRecorder::recordContacts(const Simulator& simulator)
{
  const auto bodyName = [&](const ShapeInfo& shape)
  { return shape.body >= 0 ? simulator.bodyName(shape.body) : std::string("ground"); };
  for (const ContactState& contact : simulator.contacts())
  {
    const ShapeInfo& a = simulator.shape(contact.shape_a);
    const ShapeInfo& b = simulator.shape(contact.shape_b);
    contacts_ << simulator.time() << ',' << contact.id.number() << ',' << bodyName(a) << ',' << bodyName(b) << ','
              << a.link_name << ',' << b.link_name;
    write(contacts_, contact.position);
    write(contacts_, contact.normal);
    contacts_ << ',' << contact.gap;
    write(contacts_, contact.impulse / simulator.report().dt);
    write(contacts_, contact.velocity);
    contacts_ << ',' << toString(contact.mode) << ',' << contact.friction << '\n';
  }
}

void CsvRecorder::recordReport(const StepSummary& report)
{
  const EnergyLedger& energy = report.energy;
  std::string tried = report.solvers_tried;
  for (char& letter : tried)
    letter = letter == ',' ? ' ' : letter;
  steps_ << report.step << ',' << report.time << ',' << report.dt << ',' << report.contacts << ',' << report.velocities
         << ',' << report.bilaterals << ',' << report.islands << ',' << report.solver << ',' << tried << ','
         << toString(report.status) << ',' << report.iterations << ',' << report.residual << ',' << report.solve_time
         << ',' << report.bilateral_violation << ',' << report.max_penetration << ',' << energy.kinetic << ','
         << energy.potential << ',' << energy.actuators << ',' << energy.friction << ',' << energy.impact << ','
         << energy.joints << ',' << energy.balance_error << ',' << report.contact_rounds << '\n';
}

void CsvRecorder::close()
{
  for (std::ofstream* file : {&states_, &joints_, &contacts_, &steps_, &nodes_})
  {
    if (!file->is_open())
      continue;
    file->close();
    if (!*file)
      throw std::runtime_error(folder_ + ": writing failed, is the disk full?");
  }
}

}  // namespace frictional_contact_sim
