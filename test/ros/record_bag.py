#!/usr/bin/env python3
"""record_bag: a full disk, wrong arguments and existing files get one line each; what was written stays readable."""
import os
import pathlib
import re
import resource
import signal
import subprocess
import tempfile
import unittest

import rosbag
import rospy
import rostest
from std_msgs.msg import String

import node_runner

TOPIC = "/recorded"
TEXT = "x" * 10000
FILE_LIMIT = 2500000  # [bytes]: three chunks of a bag


class RecordBagTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.bag = os.path.join(self.folder.name, "run.bag")
        self.publisher = rospy.Publisher(TOPIC, String, queue_size=100)

    def tearDown(self):
        self.publisher.unregister()
        self.folder.cleanup()

    def start(self, *arguments, **options):
        self.process = subprocess.Popen(["rosrun", "frictional_contact_sim", "record_bag", *arguments],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                        env=dict(os.environ, ROSCONSOLE_FORMAT="[${severity}] ${message}"), **options)

    def finish(self):
        """Exit code, and what was said without colours."""
        output, errors = self.process.communicate(timeout=node_runner.TIMEOUT)
        return self.process.returncode, re.sub(r"\x1b\[\d*m", "", output + errors)

    def publish(self, count):
        """As many messages, or until the recorder has ended."""
        self.assertTrue(node_runner.wait_until(
            lambda: self.publisher.get_num_connections() > 0 or self.process.poll() is not None))
        for _ in range(count):
            if self.process.poll() is not None:
                return
            self.publisher.publish(TEXT)
            rospy.rostime.wallsleep(0.002)

    def fatal(self, text):
        lines = text.strip().splitlines()
        self.assertEqual(1, len(lines), text)
        self.assertIn("FATAL", lines[0])
        return lines[0]

    def test_what_was_written_before_the_file_could_not_grow_stays_readable(self):
        self.start(self.bag, TOPIC, preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_FSIZE, (FILE_LIMIT, FILE_LIMIT)))
        self.publish(5000)
        code, text = self.finish()
        self.assertEqual(2, code, text)
        line = self.fatal(text)
        self.assertIn(self.bag + ".active: file too large", line)
        said = int(re.search(r"after (\d+) messages", line).group(1))
        reindexed = subprocess.run(["rosbag", "reindex", self.bag + ".active"], stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, timeout=node_runner.TIMEOUT)
        self.assertEqual(0, reindexed.returncode, reindexed.stdout)
        with rosbag.Bag(self.bag + ".active") as reader:
            messages = [message.data for _, message, _ in reader.read_messages()]
        self.assertEqual({TEXT}, set(messages))
        self.assertGreater(len(messages), said // 2)  # all but the chunk that was open
        self.assertEqual(0, subprocess.run(["rosbag", "info", self.bag + ".active"], stdout=subprocess.DEVNULL,
                                           timeout=node_runner.TIMEOUT).returncode)

    def test_a_full_disk_gets_one_line(self):
        os.symlink("/dev/full", self.bag + ".active")
        self.start(self.bag, TOPIC)
        self.publish(5000)
        code, text = self.finish()
        self.assertEqual(2, code, text)
        lines = [line for line in text.strip().splitlines() if "WARN" not in line]
        line = self.fatal("\n".join(lines))
        self.assertIn(self.bag + ".active: no space left on device", line)

    def test_bad_arguments_get_one_line(self):
        for arguments, words in ((["/nowhere/run.bag", TOPIC], ["/nowhere/run.bag.active", "no such file"]),
                                 ([self.bag], ["found 1 arguments", "--help"]), ([], ["found 0 arguments", "--help"]),
                                 ([self.bag, "bad topic"], ["bad topic"])):
            with self.subTest(str(arguments)):
                self.start(*arguments)
                code, text = self.finish()
                self.assertEqual(2, code, text)
                self.assertEqual(1, len(text.strip().splitlines()), text)
                for word in words:
                    self.assertIn(word, text)

    def test_an_existing_bag_is_named_and_replaced_at_the_end(self):
        pathlib.Path(self.bag).write_text("an old bag")
        self.start(self.bag, TOPIC)
        self.publish(10)
        self.assertEqual("an old bag", pathlib.Path(self.bag).read_text())
        self.process.send_signal(signal.SIGINT)
        code, text = self.finish()
        self.assertEqual(0, code, text)
        self.assertIn(self.bag + " exists", text)
        with rosbag.Bag(self.bag) as reader:
            self.assertGreater(reader.get_message_count(), 0)

    def test_help_version_and_bad_names_need_no_master(self):
        for program, words in (("simulator_node", ["~time_step", "[s]", "~hold_limit"]), ("record_bag", ["TOPIC"])):
            for arguments, code, expected in ((["--help"], 0, words), (["--help", "x"], 0, words), (["-h"], 0, words),
                                              (["--version"], 0, [program]), (["x.bag", "/x", "__name:=bad/name"][2 * (program == "simulator_node"):], 2,
                                               ["bad/name"])):
                with self.subTest(f"{program} {arguments}"):
                    done = subprocess.run(["rosrun", "frictional_contact_sim", program, *arguments],
                                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                          timeout=node_runner.TIMEOUT,
                                          env=dict(os.environ, ROS_MASTER_URI="http://localhost:1"))
                    self.assertEqual(code, done.returncode, done.stderr)
                    for word in expected:
                        self.assertIn(word, done.stdout if code == 0 else done.stderr)
                    if code != 0:
                        self.assertEqual(1, len(done.stderr.strip().splitlines()), done.stderr)


if __name__ == "__main__":
    rospy.init_node("record_bag_test")
    rostest.rosrun("frictional_contact_sim", "record_bag", RecordBagTest)
