"""Runs the network argv[1] by onnxruntime: rows of nine floats on standard input, of five on standard output, as bytes."""

import sys

import numpy
import onnxruntime

session = onnxruntime.InferenceSession(sys.argv[1], providers=["CPUExecutionProvider"])
channels = numpy.frombuffer(sys.stdin.buffer.read(), "<f4").reshape(-1, 9)
(contacts,) = session.run(None, {session.get_inputs()[0].name: channels})
sys.stdout.buffer.write(contacts.astype("<f4").tobytes())
