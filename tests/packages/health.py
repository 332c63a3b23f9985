# SPDX-License-Identifier: Apache-2.0
"""The health check of the containers: health.py docker/bin/asip-healthy"""
import os
import socket
import subprocess
import sys
import threading


def healthy(script, what, **environment):
    clean = {name: value for name, value in os.environ.items() if not name.startswith("ASIP_")}
    return subprocess.run([script, what], env=clean | environment, timeout=30).returncode == 0


def answer(listener, status):
    connection = listener.accept()[0]
    asked = b""
    while b"\r\n\r\n" not in asked:
        asked += connection.recv(4096)
    connection.sendall(f"HTTP/1.1 {status} whatever\r\n\r\n".encode())
    connection.close()


def main(script):
    faults = []

    def check(name, holds):
        print("ok  " if holds else "FAIL", name)
        faults.extend([] if holds else [name])

    listener = socket.create_server(("127.0.0.1", 0))
    port = str(listener.getsockname()[1])
    check("Listening_IsSeen", healthy(script, "listening", ASIP_BROKER_PORT=port))
    check("NotConnected_IsNotHealthy", not healthy(script, "broker", ASIP_BROKER_PORT=port))
    client = socket.create_connection(("127.0.0.1", int(port)))
    for ports in (port, f"1 {port}", f"{port} 1"):
        check(f"Connected_IsHealthy [{ports}]", healthy(script, "broker", ASIP_BROKER_PORT=ports))
    check("ConnectedElsewhere_IsNotHealthy", not healthy(script, "broker", ASIP_BROKER_PORT="1 2"))
    client.close()
    listener.accept()[0].close()
    for status in (200, 503):
        threading.Thread(target=answer, args=(listener, status), daemon=True).start()
        check(f"Http_{status}", healthy(script, "http", ASIP_HTTP_PORT=port) == (status == 200))
    listener.close()
    check("NothingListens_IsNotHealthy", not healthy(script, "http", ASIP_HTTP_PORT=port) and not healthy(script, "listening", ASIP_BROKER_PORT=port))
    # The ports that are looked at where none is given, in a network of its own.
    inside = "import socket, subprocess, sys\n" \
             "server = socket.create_server(('127.0.0.1', int(sys.argv[2]))); client = socket.create_connection(server.getsockname())\n" \
             "sys.exit(subprocess.run([sys.argv[1], 'broker']).returncode)"
    network = ["unshare", "--map-root-user", "--net"] if os.geteuid() else ["unshare", "--net"]
    if subprocess.run([*network, "ip", "link", "set", "lo", "up"], stderr=subprocess.DEVNULL).returncode == 0:
        for usual in ("8883", "1883", "1884"):
            done = subprocess.run([*network, "sh", "-c", f'ip link set lo up && exec {sys.executable} -c "$1" "$2" {usual}', "sh", inside, script])
            check(f"UsualPort_{usual}", (done.returncode == 0) == (usual != "1884"))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(os.path.abspath(sys.argv[1])))
