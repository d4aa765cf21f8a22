#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

namespace resilin {

/// How much memory this process may still take, and what says so.
struct MemoryRoom {
  double bytes;            ///< infinity where nothing limits it
  std::string_view limit;  ///< goes after "are left": "of the address space allowed (ulimit -v)"
};

/// Remainder of the address space and the data that the process may have (setrlimit): the most that it may
/// still ask for.
MemoryRoom address_space_left();

/// Memory that the control groups (v1 and v2, with those above) and the machine leave: it may still be used.
/// The cache of files, which the system gives back at need, counts as free. Reads a few small files.
MemoryRoom free_memory();

/// The lesser of the two.
MemoryRoom memory_room();

/// "310 MB are left of the address space allowed (ulimit -v)".
std::string words(const MemoryRoom& room);

/// Whether there is room for so much: a system may hand out more addresses than it has memory, and end the
/// process once they are used. Little memory is taken to fit.
bool fits(double bytes, MemoryRoom (*room)() = memory_room);

/// Memory that this process uses now [bytes]; 0 where the system does not say.
double memory_in_use();

/// Memory that the heap holds now [bytes]; 0 where the allocator does not count, as those of sanitizers.
double heap_bytes();

/// Whether so much address space can be had in one piece now: asks for it and gives it back.
bool can_allocate(std::size_t bytes);

/// An array of numbers that are yet to be written; a long one on large pages where the system has them, so
/// that fewer addresses are looked up.
std::unique_ptr<double[]> make_numbers(std::size_t count);

/// The system hands out memory, zeroed, when it is first written to: here on all threads, where it is much.
void take_pages(void* begin, std::size_t bytes);

/// `vector.assign(count, Number{})` of a long vector that holds nothing that is needed.
template <class Number>
void assign_zeros(std::vector<Number>& vector, std::size_t count) {
  vector.clear();
  if (vector.capacity() < count) {
    vector.reserve(count);
    take_pages(vector.data(), count * sizeof(Number));
  }
  vector.resize(count);
}

/// More memory is needed than there is; `what()` is one line. Whatever catches std::bad_alloc catches this.
class OutOfMemory : public std::bad_alloc {
 public:
  explicit OutOfMemory(const std::string& message) : message_(std::make_shared<const std::string>(message)) {}
  const char* what() const noexcept override { return message_->c_str(); }

 private:
  std::shared_ptr<const std::string> message_;  // copies of an exception must not throw
};

/// For who is about to take much memory. Throws OutOfMemory with the line "out of memory: WHAT needs 1.2 GB,
/// 310 MB are left of ...; CURE" where it does not fit.
void foresee_memory(double bytes, const std::string& what, const std::string& cure);

/// "some 210000 UNITS would fit", from how many there are and what they need beside what is in use.
std::string what_would_fit(double count, double bytes, const std::string& units);

/// The line about memory that ran out: that of an OutOfMemory, else that there was none, how much is left now
/// and what to do.
std::string out_of_memory_text(const std::bad_alloc& error);

}  // namespace resilin
