#!/usr/bin/python3
"""A controller in ten lines: the quadruped of simulate.launch goes up and down, half a turn a second."""
import math

import rospy
from sensor_msgs.msg import JointState

rospy.init_node("squat")
publisher = rospy.Publisher("/simulator_node/command/position", JointState, queue_size=1)
rate = rospy.Rate(100)  # of simulated time: simulate.launch sets /use_sim_time
try:
    while not rospy.is_shutdown():
        bend = 0.7 + 0.2 * math.sin(math.pi * rospy.get_time())  # [rad]
        legs = [("LF", 1), ("RF", 1), ("LH", -1), ("RH", -1)]  # hind knees bend the other way
        command = JointState(name=[f"{leg}_{joint}" for leg, _ in legs for joint in ("HFE", "KFE")],
                             position=[side * angle for _, side in legs for angle in (bend, -2 * bend)])
        publisher.publish(command)
        rate.sleep()
except rospy.ROSInterruptException:  # Ctrl-C while it sleeps
    pass
