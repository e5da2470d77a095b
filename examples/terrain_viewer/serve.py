#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Serves the present folder on http://localhost:8000 and says of *.terrain that it is compressed: serve.py [PORT]"""
import http.server
import sys


class Handler(http.server.SimpleHTTPRequestHandler):
    def end_headers(self):
        if self.path.split("?")[0].endswith(".terrain"):
            self.send_header("Content-Encoding", "gzip")
        super().end_headers()


http.server.ThreadingHTTPServer(("127.0.0.1", int(sys.argv[1]) if len(sys.argv) > 1 else 8000), Handler).serve_forever()
