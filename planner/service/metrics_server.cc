#include "planner/service/metrics_server.h"

#include <httplib.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace fjr {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr const char* kExposition = "text/plain; version=0.0.4; charset=utf-8";
constexpr time_t kSlowest = 1;  // [s] that a reader may take to say something, and between two packets
constexpr std::chrono::seconds kTryPortAgain{1}, kToEnd{1};

// Serves one reader after the other, in the thread that accepts connections, so that many readers take no more file
// descriptors than one.
class OneByOne : public httplib::TaskQueue {
 public:
  using Taken = decltype(std::declval<httplib::TaskQueue&>().enqueue({}));  // bool, but void in Debian 12
  Taken enqueue(std::function<void()> serve) override {
    serve();
    return static_cast<Taken>(true);
  }
  void shutdown() override {}
};

// Lets a restarted service listen on its port at once. httplib would set SO_REUSEPORT too, and two services could then
// share a port without either noticing.
void reuse_address(int socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

}  // namespace

struct MetricsServer::Shared {
  httplib::Server http;
  std::mutex mutex;  // for all below
  std::condition_variable changed;
  std::string text;
  bool stopping = false, ended = false;

  void set_up();
  void run(int port);
  bool wait_for_port(int port);
};

void MetricsServer::Shared::set_up() {
  http.new_task_queue = [] { return new OneByOne; };
  http.set_socket_options(reuse_address);
  http.set_keep_alive_max_count(1);
  http.set_keep_alive_timeout(kSlowest);  // before the first byte, too
  http.set_read_timeout(kSlowest);
  http.set_write_timeout(kSlowest);
  http.set_payload_max_length(0);
  http.Get("/metrics", [this](const httplib::Request&, httplib::Response& response) {
    const std::lock_guard lock(mutex);
    response.set_content(text, kExposition);
  });
}

// Waits until the port can be listened on. Returns false if the service ends before that.
bool MetricsServer::Shared::wait_for_port(int port) {
  bool told = false;
  std::unique_lock lock(mutex);
  while (!stopping) {
    const int bound = port == 0 ? http.bind_to_any_port(kLoopback) : http.bind_to_port(kLoopback, port) ? port : -1;
    if (bound > 0) {
      spdlog::info("metrics on http://{}:{}/metrics", kLoopback, bound);
      return true;
    }
    if (!std::exchange(told, true)) {
      spdlog::error("no metrics: port {} of {} cannot be listened on; tried again every second", port, kLoopback);
    }
    changed.wait_for(lock, kTryPortAgain, [this] { return stopping; });
  }
  return false;
}

void MetricsServer::Shared::run(int port) {
  if (wait_for_port(port)) http.listen_after_bind();
  const std::lock_guard lock(mutex);
  ended = true;
  changed.notify_all();
}

MetricsServer::MetricsServer(std::uint16_t port) : shared_(std::make_shared<Shared>()) {
  shared_->set_up();
  thread_ = std::thread([shared = shared_, port] { shared->run(port); });
}

// A reader that never closes its connection must not keep the service from ending: then the thread is detached. It
// shares ownership of what it uses, and ends with the process.
MetricsServer::~MetricsServer() {
  std::unique_lock lock(shared_->mutex);
  shared_->stopping = true;
  shared_->changed.notify_all();
  const auto over = std::chrono::steady_clock::now() + kToEnd;
  while (!shared_->ended && std::chrono::steady_clock::now() < over) {
    lock.unlock();
    shared_->http.stop();  // which does nothing before it listens
    lock.lock();
    shared_->changed.wait_for(lock, std::chrono::milliseconds(20), [this] { return shared_->ended; });
  }
  shared_->ended ? thread_.join() : thread_.detach();
}

void MetricsServer::publish(std::string text) {
  const std::lock_guard lock(shared_->mutex);
  shared_->text = std::move(text);
}

}  // namespace fjr
