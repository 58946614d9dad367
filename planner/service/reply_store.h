// The replies that were given, on disk: a service that is started again, after a crash too, answers the same id with
// the same. A thread of its own writes, all that waits in one transaction, so that neither a slow nor a full disk keeps
// the service from its work: what cannot be written leaves unwritten.
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "planner/protocol/messages.h"
#include "planner/store/database.h"

namespace fjr {

class ReplyStore {
 public:
  // Makes the folder where it is not there. Of a folder that several services share each knows its robot's replies.
  // `wake` is called from another thread whenever take_settled() has something to tell.
  ReplyStore(std::filesystem::path folder, std::string robot_id, std::function<void()> wake);
  ~ReplyStore();  // writes what waits

  // What was given before this start, the oldest first; once.
  std::vector<SharedReply> take_earlier() { return std::move(earlier_); }

  void add(SharedReply reply);
  void forget(const RequestId& id);

  // Whose replies may leave by now: they are on disk, or the disk does not take them.
  std::vector<RequestId> take_settled();

 private:
  using Clock = std::chrono::steady_clock;
  struct Change {
    RequestId id;
    SharedReply reply;  // none: it is to be forgotten
  };

  void load();
  void read_earlier();
  void set_aside(const std::string& why);
  void open();
  void write(const std::vector<Change>& changes);
  std::string try_to_write(const std::vector<Change>& changes);
  void keep_writing(const std::stop_token& over);
  void put_back();
  void note_settled(const std::vector<Change>& changes);
  void tell(const std::string& problem) const;

  const std::filesystem::path folder_, file_;
  const std::string robot_id_;
  const std::function<void()> wake_;
  std::vector<SharedReply> earlier_;

  std::optional<Database> database_;  // of the thread that writes
  std::mutex mutex_;                  // for all below
  std::condition_variable_any changed_;
  std::vector<Change> changes_;  // to be written
  std::vector<Change> writing_;  // by the thread, which alone changes it, while busy_since_ says so
  std::vector<RequestId> settled_;
  std::optional<Clock::time_point> busy_since_;
  bool failing_ = false;  // the disk takes nothing: it is tried again, and no reply waits for it
  std::jthread writer_;   // last: it ends before what it uses
};

}  // namespace fjr
