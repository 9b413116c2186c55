"""Runs a command once and prints its wall seconds and peak memory in MiB, as JSON."""
import json
import resource
import subprocess
import sys
import time

start = time.perf_counter()
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)
seconds = time.perf_counter() - start
print(json.dumps({"seconds": seconds, "MiB": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024}))
