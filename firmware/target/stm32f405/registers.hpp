// SPDX-License-Identifier: Apache-2.0
// The STM32F405's registers that this firmware touches. Names as in ST's reference manual RM0090 and, for the core's
// own, Arm's ARMv7-M architecture manual (B3). Addresses: RM0090 2.3, table 1.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace stillpoint::stm32f405 {

using Register = volatile uint32_t;

struct Rcc {  // RM0090 7.3
  Register CR, PLLCFGR, CFGR, CIR, AHB1RSTR, AHB2RSTR, AHB3RSTR, reserved0, APB1RSTR, APB2RSTR, reserved1[2], AHB1ENR,
      AHB2ENR, AHB3ENR, reserved2, APB1ENR, APB2ENR, reserved3[2], AHB1LPENR, AHB2LPENR, AHB3LPENR, reserved4,
      APB1LPENR, APB2LPENR, reserved5[2], BDCR, CSR;

  static constexpr uint32_t kCrHsiOn = 1u << 0, kCrHsiReady = 1u << 1;
  static constexpr uint32_t kCrHseOn = 1u << 16, kCrHseReady = 1u << 17;
  static constexpr uint32_t kCrPllOn = 1u << 24, kCrPllReady = 1u << 25;
  static constexpr uint32_t kPllcfgrSourceHse = 1u << 22;
  static constexpr uint32_t kCfgrSwitchMask = 3u << 0, kCfgrSwitchPll = 2u << 0;
  static constexpr uint32_t kCfgrStatusMask = 3u << 2, kCfgrStatusPll = 2u << 2;
  static constexpr uint32_t kCfgrApb1By4 = 5u << 10, kCfgrApb2By2 = 4u << 13;
  static constexpr uint32_t kAhb1GpioA = 1u << 0, kAhb1GpioC = 1u << 2;
  static constexpr uint32_t kApb1Usart2 = 1u << 17;
  static constexpr uint32_t kApb1Timer2 = 1u << 0;
  static constexpr uint32_t kApb2Usart1 = 1u << 4;
  static constexpr uint32_t kApb2Timer1 = 1u << 0;
  static constexpr uint32_t kCsrWatchdogReset = 1u << 29, kCsrForgetResets = 1u << 24;  // IWDGRSTF, RMVF
};
static_assert(offsetof(Rcc, APB2ENR) == 0x44, "RM0090 7.3.14");
static_assert(offsetof(Rcc, CSR) == 0x74, "RM0090 7.3.21");

struct Flash {  // RM0090 3.9
  Register ACR, KEYR, OPTKEYR, SR, CR, OPTCR;

  static constexpr uint32_t kAcrLatencyMask = 7u, kAcrLatency5 = 5u;
  static constexpr uint32_t kAcrPrefetch = 1u << 8, kAcrInstructionCache = 1u << 9, kAcrDataCache = 1u << 10;
  static constexpr uint32_t kAcrDataCacheReset = 1u << 12;
  static constexpr uint32_t kKey1 = 0x45670123, kKey2 = 0xCDEF89AB;
  static constexpr uint32_t kSrErrors = 0xF2;  // PGSERR, PGPERR, PGAERR, WRPERR, OPERR
  static constexpr uint32_t kSrBusy = 1u << 16;
  static constexpr uint32_t kCrProgram = 1u << 0, kCrSectorErase = 1u << 1;
  static constexpr uint32_t kCrSectorShift = 3;
  static constexpr uint32_t kCrWords = 2u << 8;  // PSIZE: 32 bits at a time, 2.7-3.6 V
  static constexpr uint32_t kCrStart = 1u << 16, kCrLock = 1u << 31;
};

static_assert(offsetof(Flash, OPTCR) == 0x14, "RM0090 3.9.10");

struct Gpio {  // RM0090 8.4
  Register MODER, OTYPER, OSPEEDR, PUPDR, IDR, ODR, BSRR, LCKR, AFR[2];
};
static_assert(offsetof(Gpio, AFR) == 0x20, "RM0090 8.4.9");

struct Usart {  // RM0090 30.6
  Register SR, DR, BRR, CR1, CR2, CR3, GTPR;

  static constexpr uint32_t kSrReceived = 1u << 5;            // RXNE
  static constexpr uint32_t kSrTransmitComplete = 1u << 6;    // TC
  static constexpr uint32_t kSrTransmitReady = 1u << 7;       // TXE
  static constexpr uint32_t kCr1ReceiveOn = 1u << 2;          // RE
  static constexpr uint32_t kCr1TransmitOn = 1u << 3;         // TE
  static constexpr uint32_t kCr1ReceiveInterrupt = 1u << 5;   // RXNEIE
  static constexpr uint32_t kCr1CompleteInterrupt = 1u << 6;  // TCIE
  static constexpr uint32_t kCr1TransmitInterrupt = 1u << 7;  // TXEIE
  static constexpr uint32_t kCr1ParityOdd = 1u << 9;          // PS
  static constexpr uint32_t kCr1ParityOn = 1u << 10;          // PCE, even while PS is 0
  static constexpr uint32_t kCr1NineBits = 1u << 12;          // M: the word with its parity bit
  static constexpr uint32_t kCr1UsartOn = 1u << 13;           // UE
  static constexpr uint32_t kCr1OversampleBy8 = 1u << 15;     // OVER8
  static constexpr uint32_t kCr2TwoStops = 2u << 12;          // STOP
};

struct Timer {  // RM0090 17.4 (TIM1 and TIM8) and 18.4 (TIM2 to TIM5, which have no RCR and no BDTR)
  Register CR1, CR2, SMCR, DIER, SR, EGR, CCMR1, CCMR2, CCER, CNT, PSC, ARR, RCR, CCR[4], BDTR, DCR, DMAR;

  static constexpr uint32_t kCr1On = 1u << 0;                 // CEN
  static constexpr uint32_t kCr1UpdateByOverflow = 1u << 2;   // URS: UG sets no flag
  static constexpr uint32_t kCr1OnePulse = 1u << 3;           // OPM: the next update clears CEN
  static constexpr uint32_t kCr1ReloadBuffered = 1u << 7;     // ARPE
  static constexpr uint32_t kSmcrEncoderBoth = 3u << 0;       // SMS 011: counts the edges of both inputs
  static constexpr uint32_t kEgrUpdate = 1u << 0;             // UG: CNT to 0; PSC, ARR, RCR, CCR into force
  static constexpr uint32_t kCcmr1Input1 = 1u << 0;           // CC1S 01: IC1 is TI1
  static constexpr uint32_t kCcmr1Input2 = 1u << 8;           // CC2S 01: IC2 is TI2
  static constexpr uint32_t kCcmr1Filter1By6 = 4u << 4;       // IC1F 0100: six samples of f_DTS / 2 alike
  static constexpr uint32_t kCcmr1Filter2By6 = 4u << 12;      // IC2F
  static constexpr uint32_t kCcmr1Buffered1 = 1u << 3;        // OC1PE
  static constexpr uint32_t kCcmr1HighFromCompare = 7u << 4;  // OC1M 111, PWM mode 2: low while CNT < CCR1
  static constexpr uint32_t kCcerOutput1 = 1u << 0;           // CC1E
  static constexpr uint32_t kBdtrOutputsOn = 1u << 15;        // MOE
};
static_assert(offsetof(Timer, CNT) == 0x24, "RM0090 17.4.10");
static_assert(offsetof(Timer, RCR) == 0x30, "RM0090 17.4.13");
static_assert(offsetof(Timer, CCR) == 0x34, "RM0090 17.4.14");
static_assert(offsetof(Timer, BDTR) == 0x44, "RM0090 17.4.18");
static_assert(offsetof(Timer, DMAR) == 0x4C, "RM0090 17.4.20");

struct Iwdg {  // RM0090 21.4
  Register KR, PR, RLR, SR;

  static constexpr uint32_t kKeyFeed = 0xAAAA, kKeyUnlock = 0x5555, kKeyStart = 0xCCCC;
  static constexpr uint32_t kPrescaleBy64 = 4;
  static constexpr uint32_t kSrBusy = 3;
};

struct SysTick {  // ARMv7-M B3.3
  Register CTRL, LOAD, VAL, CALIB;

  static constexpr uint32_t kCtrlOn = 1u << 0, kCtrlInterrupt = 1u << 1, kCtrlProcessorClock = 1u << 2;
};

struct Scb {  // ARMv7-M B3.2
  Register CPUID, ICSR, VTOR, AIRCR, SCR, CCR, SHPR[3], SHCSR, CFSR, HFSR, DFSR, MMFAR, BFAR, AFSR, reserved[18], CPACR;

  static constexpr uint32_t kAircrReset = 0x05FA0004;        // VECTKEY and SYSRESETREQ
  static constexpr uint32_t kIcsrSysTickPending = 1u << 26;  // PENDSTSET
  static constexpr uint32_t kShcsrFaultsOn = 7u << 16;       // usage, bus, memory management
  static constexpr uint32_t kCpacrFpu = 0xFu << 20;          // CP10 and CP11, full access
};
static_assert(offsetof(Scb, CPACR) == 0x88, "ARMv7-M B3.2.20");

struct Nvic {  // ARMv7-M B3.4
  Register ISER[8], reserved0[24], ICER[8], reserved1[24], ISPR[8], reserved2[24], ICPR[8], reserved3[24], IABR[8],
      reserved4[56];
  volatile uint8_t IPR[240];
};
static_assert(offsetof(Nvic, IPR) == 0x300, "ARMv7-M B3.4");

template <typename T, uintptr_t kAddress>
inline T& at() {
  return *reinterpret_cast<T*>(kAddress);
}

inline Rcc& rcc() { return at<Rcc, 0x40023800>(); }
inline Flash& flash() { return at<Flash, 0x40023C00>(); }
inline Gpio& gpio_a() { return at<Gpio, 0x40020000>(); }
inline Gpio& gpio_c() { return at<Gpio, 0x40020800>(); }
inline Usart& usart1() { return at<Usart, 0x40011000>(); }
inline Usart& usart2() { return at<Usart, 0x40004400>(); }
inline Timer& timer1() { return at<Timer, 0x40010000>(); }
inline Timer& timer2() { return at<Timer, 0x40000000>(); }
inline Iwdg& iwdg() { return at<Iwdg, 0x40003000>(); }
inline SysTick& systick() { return at<SysTick, 0xE000E010>(); }
inline Scb& scb() { return at<Scb, 0xE000ED00>(); }
inline Nvic& nvic() { return at<Nvic, 0xE000E100>(); }

// Positions in the vector table (RM0090 12.2, table 61).
enum class Interrupt : uint32_t { kUsart1 = 37, kUsart2 = 38 };
constexpr uint32_t kInterruptCount = 82;

// The four priority bits that the chip has. Lower is more urgent; equal ones never interrupt each other.
enum class Priority : uint8_t { kTick = 0x40, kClient = 0x80 };

inline void enable(Interrupt interrupt, Priority priority) {
  const uint32_t number = static_cast<uint32_t>(interrupt);
  nvic().IPR[number] = static_cast<uint8_t>(priority);
  nvic().ISER[number / 32] = 1u << (number % 32);
}

inline void pend(Interrupt interrupt) {
  const uint32_t number = static_cast<uint32_t>(interrupt);
  nvic().ISPR[number / 32] = 1u << (number % 32);
}

}  // namespace stillpoint::stm32f405
