//! A painted stack for one function, and the call on it.

const PAINT: u32 = 0xa5a5_5a5a;
/// Words of a usual one.
pub const WORDS: usize = 512;

/// A stack of its own.
#[repr(C, align(8))]
pub struct Stack<const N: usize = WORDS>([u32; N]);

impl<const N: usize> Stack<N> {
    /// Fresh paint.
    pub const PAINTED: Self = Self([PAINT; N]);

    /// One past its highest word, where an empty stack stands.
    pub fn top(&mut self) -> *mut u32 {
        self.0.as_mut_ptr_range().end
    }

    /// Bytes that a call used.
    #[must_use]
    pub fn used(&self) -> usize {
        let untouched = self.0.iter().take_while(|word| **word == PAINT).count();
        (N - untouched) * size_of::<u32>()
    }
}

/// Declares painted stacks.
#[macro_export]
macro_rules! painted {
    ($($name:ident),+ $(,)?) => { $(let mut $name = $crate::stack::Stack::<{ $crate::stack::WORDS }>::PAINTED;)+ };
}

/// Calls an item on its stack. What it says goes nowhere.
///
/// The `bl` is written out, so that the plugin finds it and nothing of this loop is counted.
#[macro_export]
macro_rules! call {
    ($stack:ident, $item:path, $state:expr, $input:expr) => {
        $crate::on_stack!($stack, $item, $state, $input, "bl {item}", sym $item)
    };
}

/// The same for a call that is not to be counted: the plugin looks for `bl`.
#[macro_export]
macro_rules! call_uncounted {
    ($stack:expr, $item:expr, $state:expr, $input:expr) => {
        $crate::on_stack!($stack, $item, $state, $input, "blx {item}", in(reg) $item)
    };
}

/// Both of them: the branch, and how the assembler gets at the item.
#[doc(hidden)]
#[macro_export]
macro_rules! on_stack {
    ($stack:expr, $item:expr, $state:expr, $input:expr, $branch:literal, $($operand:tt)+) => {
        $crate::stack::with_types($item, $state, $input, |state, input, output| {
            // SAFETY: the arguments are those of the function, by its type; its stack is large
            // enough, which `used` shows, and nothing else uses it; no interrupt is on.
            unsafe {
                core::arch::asm!(
                    "mov r4, sp",
                    "mov sp, {top}",
                    $branch,
                    "mov sp, r4",
                    top = in(reg) $stack.top(),
                    item = $($operand)+,
                    in("r0") state,
                    in("r1") input,
                    in("r2") output,
                    out("r4") _,
                    // What a callee may change; `clobber_abi` would name registers that a
                    // Cortex-M4F does not have.
                    lateout("r0") _, lateout("r1") _, lateout("r2") _, lateout("r3") _,
                    lateout("r12") _, lateout("lr") _,
                    #[cfg(target_abi = "eabihf")] lateout("d0") _,
                    #[cfg(target_abi = "eabihf")] lateout("d1") _,
                    #[cfg(target_abi = "eabihf")] lateout("d2") _,
                    #[cfg(target_abi = "eabihf")] lateout("d3") _,
                    #[cfg(target_abi = "eabihf")] lateout("d4") _,
                    #[cfg(target_abi = "eabihf")] lateout("d5") _,
                    #[cfg(target_abi = "eabihf")] lateout("d6") _,
                    #[cfg(target_abi = "eabihf")] lateout("d7") _,
                );
            }
        })
    };
}

/// Has the compiler check an item's arguments and find room for its output.
#[inline(always)]
pub fn with_types<S, I, O>(
    _item: extern "C" fn(&mut S, &I, &mut O),
    state: &mut S,
    input: &I,
    call: impl FnOnce(*mut S, *const I, *mut O),
) {
    let mut output = core::mem::MaybeUninit::uninit();
    call(state, input, output.as_mut_ptr());
}

/// Says of each item, in a line, how large its state is and how much stack it used.
#[macro_export]
macro_rules! report {
    ($($item:ident: $state:expr,)+) => {
        $($crate::hprintln!(
            "item {} {} {}", stringify!($item), core::mem::size_of_val(&$state), $item.used()
        );)+
    };
}
