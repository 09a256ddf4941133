#!/usr/bin/env python3
"""Reads a bag of simulate.launch and says whether a robot stands in it: the end of scripts/demo.

    check_demo_bag.py BAG URDF [--steps N] [--last SECONDS]

Exit code 0 only when the bag holds every step of every topic once, with one stamp each, the contact forces of the last
half second balance the weight, the robot is at rest, and every step was solved; 2 where a file cannot be read.
"""
import argparse
import sys
import xml.etree.ElementTree as ElementTree

import rosbag
import rospkg

FORCE_TOLERANCE = 1e-4  # relative, worst sample
RESIDUAL_TOLERANCE = 1e-8
SPEED_TOLERANCE = 1e-3  # of the base at the end [m/s]
GRAVITY = 9.81
CONVERGED = 1


def mass_of(urdf):
    root = ElementTree.parse(urdf).getroot()
    return sum(float(mass.get("value")) for mass in root.findall("link/inertial/mass"))


def read(path):
    """{topic: [message, ...]} of a bag."""
    messages = {}
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages():
            messages.setdefault(topic, []).append(message)
    return messages


def count_problems(messages, steps):
    """Every topic: one record a step, stamps those of the step reports."""
    problems = []
    reports = messages.get("/simulator_node/step_report", [])
    stamps = [report.header.stamp for report in reports]
    if steps and len(reports) != steps:
        problems.append(f"step_report: {len(reports)} records of {steps} steps")
    numbers = [report.step for report in reports]
    if numbers != list(range(1, len(reports) + 1)):
        problems.append("step_report: steps are missing or out of order")
    for topic in ("/joint_states", "/simulator_node/contacts", "/simulator_node/ground_truth/odom"):
        found = [message.header.stamp for message in messages.get(topic, [])]
        if found != stamps:
            problems.append(f"{topic}: {len(found)} records, or stamps other than those of the {len(stamps)} steps")
    if any(stamp.is_zero() for stamp in stamps):
        problems.append("a stamp is zero")
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    if "--version" in sys.argv:
        print("check_demo_bag.py", rospkg.RosPack().get_manifest("frictional_contact_sim").version)
        return 0
    parser.add_argument("bag")
    parser.add_argument("urdf")
    parser.add_argument("--version", action="store_true", help="print it and leave")
    parser.add_argument("--steps", type=int, default=0, help="number of steps that the run had")
    parser.add_argument("--last", type=float, default=0.5, help="window at the end for the force balance [s]")
    arguments = parser.parse_args()

    try:
        messages, mass = read(arguments.bag), mass_of(arguments.urdf)
    except (OSError, ValueError, rosbag.ROSBagException, ElementTree.ParseError) as error:
        print(f"check_demo_bag: {arguments.bag}, {arguments.urdf}: {error}; expected a bag of simulate.launch and a URDF file",
              file=sys.stderr)
        return 2
    reports = messages.get("/simulator_node/step_report", [])
    if not reports:
        print(f"check_demo_bag: {arguments.bag} holds no step_report")
        return 1
    problems = count_problems(messages, arguments.steps)

    weight = mass * GRAVITY
    end = reports[-1].header.stamp.to_sec()
    sums = [sum(contact.force.x * contact.normal.x + contact.force.y * contact.normal.y +
                contact.force.z * contact.normal.z for contact in message.contacts if not contact.body_b)
            for message in messages.get("/simulator_node/contacts", [])
            if message.header.stamp.to_sec() > end - arguments.last]
    deviations = [abs(total - weight) / weight for total in sums] or [float("inf")]
    mean = sum(sums) / max(len(sums), 1)
    residual = max(report.residual for report in reports)
    failed = sum(report.status != CONVERGED for report in reports)
    # Kinetic energy is at least that of the centre of mass: m v^2 / 2.
    speed = (2.0 * reports[-1].kinetic * GRAVITY / weight) ** 0.5

    print(f"  {'robot mass':34s} {weight / GRAVITY:14.6f} kg")
    print(f"  {'weight':34s} {weight:14.6f} N")
    print(f"  {'sum of normal forces, mean':34s} {mean:14.6f} N     over the last {arguments.last} s")
    print(f"  {'deviation of the mean':34s} {abs(mean - weight) / weight:14.3e}")
    print(f"  {'worst sample':34s} {max(deviations):14.3e}       at most {FORCE_TOLERANCE:g}")
    print(f"  {'worst residual':34s} {residual:14.3e}       at most {RESIDUAL_TOLERANCE:g}")
    print(f"  {'steps not converged':34s} {failed:14d}")
    print(f"  {'largest penetration':34s} {max(report.max_penetration for report in reports):14.3e} m")
    print(f"  {'bound on centre of mass speed, end':34s} {speed:14.3e} m/s   at most {SPEED_TOLERANCE:g}")
    print(f"  {'real-time factor, end':34s} {reports[-1].real_time_factor:14.3f}")
    print(f"  {'steps':34s} {arguments.steps or len(reports):14d}")
    for topic in sorted(messages):
        print(f"  {'records of ' + topic:34s} {len(messages[topic]):14d}")

    if max(deviations) > FORCE_TOLERANCE:
        problems.append("the contact forces do not balance the weight")
    if residual > RESIDUAL_TOLERANCE or failed:
        problems.append("a step was not solved")
    if not speed <= SPEED_TOLERANCE:
        problems.append("the robot is not at rest")
    for problem in problems:
        print(f"FAILED: {problem}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
