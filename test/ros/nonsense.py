"""What a node may answer to getBusStats, most of it wrong. Each is a function of the HTTP handler."""
import random
import socket
import time
import xmlrpc.client

from raw_subscriber import answer

TOPIC = "/joint_states"


def body(value):
    return lambda handler: handler.reply(answer(value))


def raw(data, code=200, length=None):
    return lambda handler: handler.reply(data, code, length)


def hang(handler):
    time.sleep(30.0)


def hang_up(handler):
    handler.connection.shutdown(socket.SHUT_RDWR)


def trickle(handler):
    handler.reply(b"", length=1000000)
    for _ in range(100):
        handler.wfile.write(b" ")
        time.sleep(0.1)


def fault(handler):
    handler.reply(xmlrpc.client.dumps(xmlrpc.client.Fault(-1, "no such method")).encode())


def statistics(messages, drops=0):
    return [1, "", [[], [[TOPIC, [[1, 0, messages, drops, 1]]]], []]]


NONSENSE = {
    "hangs": hang, "hangs up": hang_up, "trickles": trickle, "has no such method": fault,
    "server error": raw(b"", code=500), "no XML": raw(b"\x00\xff<<<>"), "empty": raw(b""),
    "cut": raw(answer(statistics(5))[:150]), "more announced than sent": raw(b"<?xml", length=2 ** 40),
    "negative length": raw(b"<?xml", length=-7), "a number": body(7), "a text": body("nothing"), "a struct": body({"a": 1}),
    "error status": body([0, "failed", 0]), "short": body([1]), "empty list": body([]), "true": body(True),
    "text for lists": body([1, "", "abc"]), "text for subscriptions": body([1, "", [[], "abc", []]]),
    "topic is a number": body([1, "", [[], [[5, [[1, 0, 3, 0, 1]]]], []]]),
    "connections are a number": body([1, "", [[], [[TOPIC, 4]], []]]),
    "counts are texts": body([1, "", [[], [[TOPIC, [["a", "b", "c", "d", "e"]]]], []]]),
    "counts are fractions": body([1, "", [[], [[TOPIC, [[1.5, 1e300, 2.5, -1e300, 0.1]]]], []]]),
    "no counts": body([1, "", [[], [[TOPIC, [[]]]], []]]), "nothing received": body(statistics(0)),
    "below zero": body(statistics(-2 ** 31)), "drops below zero": body(statistics(0, -2 ** 31)),
    "integer of 20 digits": raw(answer(statistics(12345)).replace(b"12345", b"98765432109876543210")),
}


def random_value(dice, depth):
    kind = dice.randrange(8 if depth else 5)
    if kind < 5:
        return [dice.randrange(-2 ** 31, 2 ** 31), dice.uniform(-1e300, 1e300), TOPIC, "", True][kind]
    if kind == 5:
        return {"key": random_value(dice, depth - 1)}
    return [random_value(dice, depth - 1) for _ in range(dice.randrange(5))]


def random_answers(seed):
    """A new one each time."""
    dice = random.Random(seed)

    def reply(handler):
        data = answer([1, "", [[], [[TOPIC, [random_value(dice, 2)]], random_value(dice, 4)], []]])
        if dice.random() < 0.3:  # some bytes changed
            changed = bytearray(data)
            for _ in range(5):
                changed[dice.randrange(len(changed))] = dice.randrange(256)
            data = bytes(changed)
        handler.reply(data)
    return reply
