// SPDX-License-Identifier: MIT
// Drags a file onto another program's window and lets go of it there, as a file manager would (XDND, version 5).
//   drop_file WINDOW FILE     ends with 0 once the window says that it has taken the file, else with 1
#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

namespace {

constexpr long version = 5;

class Drag {
 public:
  Drag(Display* display, Window target, const std::string& file)
      : display_{display},
        target_{target},
        source_{XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0)},
        list_{"file://" + file + "\r\n"} {
    XSetSelectionOwner(display_, atom("XdndSelection"), source_, CurrentTime);
  }

  // Over the window, then let go, then handing the name over for as long as it is asked for.
  bool drop() {
    send("XdndEnter", version << 24, static_cast<long>(atom("text/uri-list")), 0, 0);
    send("XdndPosition", 0, 500 << 16 | 400, CurrentTime, static_cast<long>(atom("XdndActionCopy")));
    if (!wait_for("XdndStatus")) return false;
    send("XdndDrop", 0, CurrentTime, 0, 0);
    return wait_for("XdndFinished");
  }

 private:
  [[nodiscard]] Atom atom(const char* name) const { return XInternAtom(display_, name, False); }

  void send(const char* message, long b, long c, long d, long e) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = target_;
    event.xclient.message_type = atom(message);
    event.xclient.format = 32;
    const long words[] = {static_cast<long>(source_), b, c, d, e};
    std::copy(std::begin(words), std::end(words), event.xclient.data.l);
    XSendEvent(display_, target_, False, NoEventMask, &event);
    XFlush(display_);
  }

  bool wait_for(const char* message) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{30};
    while (std::chrono::steady_clock::now() < end) {
      if (XPending(display_) == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
        continue;
      }
      XEvent event{};
      XNextEvent(display_, &event);
      if (event.type == SelectionRequest) hand_over(event.xselectionrequest);
      if (event.type == ClientMessage && event.xclient.message_type == atom(message)) return true;
    }
    std::fprintf(stderr, "drop_file: no %s\n", message);
    return false;
  }

  void hand_over(const XSelectionRequestEvent& request) {
    XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(list_.data()), static_cast<int>(list_.size()));
    XEvent answer{};
    answer.xselection.type = SelectionNotify;
    answer.xselection.requestor = request.requestor;
    answer.xselection.selection = request.selection;
    answer.xselection.target = request.target;
    answer.xselection.property = request.property;
    answer.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &answer);
    XFlush(display_);
  }

  Display* display_;
  Window target_;
  Window source_;
  std::string list_;
};

}  // namespace

int main(int argc, char** argv) {
  Display* display = argc == 3 ? XOpenDisplay(nullptr) : nullptr;
  if (display == nullptr) {
    std::fprintf(stderr, "usage: drop_file WINDOW FILE, on a display\n");
    return 1;
  }
  const bool taken = Drag{display, std::strtoul(argv[1], nullptr, 0), argv[2]}.drop();
  XCloseDisplay(display);
  return taken ? 0 : 1;
}
