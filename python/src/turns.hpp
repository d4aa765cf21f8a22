#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>

#include "bindings.hpp"

namespace resilin::python {

/// Lets one Python thread at a time work with an object, in the order in which they came.
///
/// Who waits does so without the GIL, so that who works can take it, and is woken by Ctrl-C.
class Turns {
 public:
  /// A look may come between the parts of long work, a change not.
  enum class Kind { look, change };

  /// Has the turn from its construction to its destruction. To be made and destroyed with the GIL.
  class Turn {
   public:
    Turn(Turns& turns, Kind kind) : turns_(turns) { turns_.begin(kind); }
    ~Turn() { turns_.end(); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    Turns& turns_;
  };

  /// Between two parts of long work: who waits for a look comes first. To be called by who has the turn,
  /// without the GIL.
  void let_others_look();

  /// While it lives, the thread that has the turn may look, too: in a function that it calls.
  class Opening {
   public:
    explicit Opening(Turns& turns) : turns_(turns) { turns_.is_open_ = true; }
    ~Opening() { turns_.is_open_ = false; }
    Opening(const Opening&) = delete;
    Opening& operator=(const Opening&) = delete;

   private:
    Turns& turns_;
  };

 private:
  struct Waiter {
    std::uint64_t number;
    Kind kind;
  };

  void begin(Kind kind);
  void end();
  void take(std::uint64_t number);
  bool is_mine() const { return depth_ > 0 && owner_ == std::this_thread::get_id(); }
  bool is_next(std::uint64_t number) const;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Waiter> waiting_;  ///< the first one first
  std::uint64_t last_number_ = 0;
  std::thread::id owner_;
  int depth_ = 0;                  ///< how often the owner has begun; 0: nobody works
  std::uint64_t looks_until_ = 0;  ///< in a pause of long work: looks up to this number may begin; else 0
  bool is_open_ = false;           ///< read and written by the owner alone
};

}  // namespace resilin::python
