// n floats that calculate as one number: a scalar for the templates of this folder that evaluates n places at once.
//
// Arithmetic is that of compiler vectors (GCC's and Clang's), split or joined to fit the processor. Comparisons give
// masks, and choices are made by select() (select.h); a formula that branches on values does not compile. The functions
// have single precision; their largest errors over their arguments, against exact values, are:
//
//   exp     1e-7 relative, zero below -87   argument at most 88
//   asin    2e-7 absolute                   argument within [-1, 1]
//   atan2   3e-7 absolute                   atan2(0, 0) = 0
//   floor   exact                           argument within +-2^31
//
// Sources: the polynomials are those of Cephes (Moshier), expf, asinf and atanf.
//
// Packets have copy constructors of their own, so that they are passed in memory whatever registers the processor has.
//
// Packets wider than the registers of the processors that the build is for are slower than narrow ones. Choosing the
// width at run time was tried and given up: GCC 12 does not carry target attributes (target_clones, flatten) through
// the templates, and sources compiled for newer processors leave their instantiations of shared templates to the whole
// program.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <numbers>

#if defined(__SSE__)
#include <xmmintrin.h>
#else
#include <cmath>
#endif

namespace renderer {

template <class Number, int n>
struct CompilerVector {
  typedef Number type __attribute__((vector_size(n * sizeof(Number))));
};

template <int n>
class Packet {
 public:
  using Floats = typename CompilerVector<float, n>::type;
  using Bits = typename CompilerVector<std::int32_t, n>::type;

  class Mask {
   public:
    explicit Mask(const Bits& bits) : bits_(bits) {}
    Mask(const Mask& other) : bits_(other.bits_) {}
    Mask& operator=(const Mask& other) = delete;

   private:
    friend class Packet;
    Bits bits_;
  };

  Packet() = default;
  Packet(const Packet& other) : v_(other.v_) {}
  Packet& operator=(const Packet& other) {
    v_ = other.v_;
    return *this;
  }
  Packet(float value) : v_(value - Floats{}) {}  // implicit, as from float to double
  explicit Packet(double value) : Packet(static_cast<float>(value)) {}
  explicit Packet(int value) : Packet(static_cast<float>(value)) {}
  explicit Packet(const Floats& v) : v_(v) {}

  static Packet load(const float* from) {
    Floats v;
    std::memcpy(&v, from, sizeof v);
    return Packet(v);
  }
  void store(float* to) const { std::memcpy(to, &v_, sizeof v_); }
  float operator[](int lane) const { return v_[lane]; }
  void set(int lane, float value) { v_[lane] = value; }

  friend Packet operator+(const Packet& a, const Packet& b) { return Packet(Floats(a.v_ + b.v_)); }
  friend Packet operator-(const Packet& a, const Packet& b) { return Packet(Floats(a.v_ - b.v_)); }
  friend Packet operator*(const Packet& a, const Packet& b) { return Packet(Floats(a.v_ * b.v_)); }
  friend Packet operator/(const Packet& a, const Packet& b) { return Packet(Floats(a.v_ / b.v_)); }
  friend Packet operator-(const Packet& a) { return Packet(Floats(-a.v_)); }
  Packet& operator+=(const Packet& b) { return v_ += b.v_, *this; }
  Packet& operator-=(const Packet& b) { return v_ -= b.v_, *this; }
  Packet& operator*=(const Packet& b) { return v_ *= b.v_, *this; }
  Packet& operator/=(const Packet& b) { return v_ /= b.v_, *this; }
  friend Mask operator<(const Packet& a, const Packet& b) { return Mask(a.v_ < b.v_); }
  friend Mask operator>(const Packet& a, const Packet& b) { return Mask(a.v_ > b.v_); }
  friend Packet select(const Mask& mask, const Packet& yes, const Packet& no) { return choose(mask, yes, no); }

  friend Packet abs(const Packet& a) { return Packet(Floats(Bits(a.v_) & 0x7fffffff)); }
  friend Packet min(const Packet& a, const Packet& b) { return Packet(Floats(a.v_ < b.v_ ? a.v_ : b.v_)); }
  friend Packet max(const Packet& a, const Packet& b) { return Packet(Floats(a.v_ > b.v_ ? a.v_ : b.v_)); }
  friend Packet floor(const Packet& a) {
    const Floats whole = __builtin_convertvector(__builtin_convertvector(a.v_, Bits), Floats);  // towards zero
    return Packet(Floats(whole > a.v_ ? whole - 1.0f : whole));
  }

  friend Packet sqrt(const Packet& a) {
    Packet root;
#if defined(__SSE__)
    for (int i = 0; i < n; i += 4) {
      __m128 quarter;
      std::memcpy(&quarter, reinterpret_cast<const float*>(&a.v_) + i, sizeof quarter);
      quarter = _mm_sqrt_ps(quarter);
      std::memcpy(reinterpret_cast<float*>(&root.v_) + i, &quarter, sizeof quarter);
    }
#else
    for (int i = 0; i < n; ++i) root.v_[i] = std::sqrt(a.v_[i]);
#endif
    return root;
  }

  friend Packet exp(const Packet& a) {
    const Floats x = a.v_ < -87.0f ? Floats{} - 87.0f : a.v_;
    const Floats scaled = x * 1.44269504088896341f;
    const Bits power = __builtin_convertvector(scaled < 0.0f ? scaled - 0.5f : scaled + 0.5f, Bits);
    const Floats whole = __builtin_convertvector(power, Floats);
    const Packet r(Floats(x - whole * 0.693359375f + whole * 2.12194440e-4f));  // ln 2 in two parts
    const Packet p = polynomial(r, 1.0f, 1.0f, 5.0000001201e-1f, 1.6666665459e-1f, 4.1665795894e-2f, 8.3334519073e-3f,
                                1.3981999507e-3f, 1.9875691500e-4f);
    const Floats value = p.v_ * Floats((power + 127) << 23);
    return Packet(Floats(a.v_ < -87.0f ? Floats{} : value));
  }

  friend Packet asin(const Packet& a) {
    const Packet magnitude = abs(a);
    const Mask outer = magnitude > 0.5f;  // asin x = pi/2 - 2 asin sqrt((1 - x) / 2)
    const Packet z = select(outer, 0.5f * (1.0f - magnitude), magnitude * magnitude);
    const Packet x = select(outer, sqrt(z), magnitude);
    const Packet p =
        polynomial(z, 1.6666752422e-1f, 7.4953002686e-2f, 4.5470025998e-2f, 2.4181311049e-2f, 4.2163199048e-2f);
    const Packet inner = x + x * z * p;
    return with_sign_of(a, select(outer, 1.57079632679489662f - 2.0f * inner, inner));
  }

  friend Packet atan2(const Packet& y, const Packet& x) {
    const Packet ay = abs(y), ax = abs(x), low = min(ay, ax), high = max(ay, ax);
    const Mask outer = low > 0.414213562373095f * high;  // atan q = pi/4 + atan((q - 1) / (q + 1))
    const Packet top = select(outer, low - high, low), bottom = select(outer, low + high, high);
    const Packet q = select(bottom > 0.0f, top / bottom, Packet(0.0f)), z = q * q;
    const Packet p = polynomial(z, -3.33329491539e-1f, 1.99777106478e-1f, -1.38776856032e-1f, 8.05374449538e-2f);
    Packet angle = q + q * z * p + select(outer, Packet(0.785398163397448310f), Packet(0.0f));
    angle = select(ay > ax, 1.57079632679489662f - angle, angle);
    angle = select(x < 0.0f, std::numbers::pi_v<float> - angle, angle);
    return with_sign_of(y, angle);
  }

  // The polynomial c0 + c1 x + c2 x^2 + ...
  template <class... More>
  friend Packet polynomial(const Packet& x, float c0, More... more) {
    if constexpr (sizeof...(more) == 0)
      return Packet(c0);
    else
      return c0 + x * polynomial(x, more...);
  }

 private:
  static Packet choose(const Mask& mask, const Packet& yes, const Packet& no) {
    return Packet(Floats(mask.bits_ ? yes.v_ : no.v_));
  }
  static Packet with_sign_of(const Packet& a, const Packet& magnitude) {
    const Bits sign = Bits{} + std::int32_t(0x80000000);
    return Packet(Floats((Bits(a.v_) & sign) | Bits(magnitude.v_)));
  }

  Floats v_;
};

// The number of floats that the processors that the build is for calculate in one instruction.
#if defined(__AVX512F__)
inline constexpr int kPacketWidth = 16;
#elif defined(__AVX2__)
inline constexpr int kPacketWidth = 8;
#else
inline constexpr int kPacketWidth = 4;
#endif

}  // namespace renderer

template <int n>
struct Eigen::NumTraits<renderer::Packet<n>> : Eigen::GenericNumTraits<float> {
  using Real = renderer::Packet<n>;
  using NonInteger = renderer::Packet<n>;
  using Nested = renderer::Packet<n>;
  using Literal = renderer::Packet<n>;
  enum { RequireInitialization = 0, ReadCost = 1, AddCost = 1, MulCost = 1 };
};
