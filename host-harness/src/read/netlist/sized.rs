//! The model counts nodes and elements by its type; a file does not.

use plant_core::Accum;
use plant_core::circuit::{
    Books, Branch, Circuit, CircuitError, CircuitInput, CircuitOutput, CircuitState, Element,
};

use super::Netlist;

/// The most elements of a circuit from a file.
pub const ELEMENTS: usize = 32;
/// The most nodes, the ground included.
pub const NODES: usize = 16;
/// An element that is not there.
const NOTHING: Branch = Branch::new(1, 0, Element::Current);

/// A circuit of whatever size, and its state.
pub trait Stepping {
    /// Advances by one step.
    fn step(&mut self, input: CircuitInput<ELEMENTS>) -> (CircuitOutput<ELEMENTS>, Books);
}

struct Sized<const N: usize> {
    circuit: Circuit<N, ELEMENTS>,
    state: CircuitState<ELEMENTS>,
}

impl<const N: usize> Stepping for Sized<N> {
    fn step(&mut self, input: CircuitInput<ELEMENTS>) -> (CircuitOutput<ELEMENTS>, Books) {
        let before = self.state;
        let out = self.circuit.step(&mut self.state, input);
        (out, self.circuit.books(&before, &self.state, &out))
    }
}

impl Netlist {
    /// The circuit as it is at the start.
    ///
    /// # Errors
    /// [`CircuitError`]; none for what [`parse`](super::parse) gives.
    pub fn circuit(&self) -> Result<Box<dyn Stepping>, CircuitError> {
        let mut branches = [NOTHING; ELEMENTS];
        let mut state = CircuitState::default();
        for ((branch, stored), part) in branches.iter_mut().zip(&mut state.stored).zip(&self.parts)
        {
            *branch = part.branch;
            *stored = Accum::new(part.initial);
        }
        // A circuit that has but the ground lacks node 1, and says so.
        let size = self.nodes.len().max(2);
        macro_rules! of_size {
            ($($nodes:literal)*) => {
                match size {
                    $($nodes => Ok(Box::new(Sized::<$nodes> {
                        circuit: Circuit::new(branches, self.method, self.step)?,
                        state,
                    })),)*
                    _ => Err(CircuitError::TooLarge(size)),
                }
            };
        }
        of_size!(2 3 4 5 6 7 8 9 10 11 12 13 14 15 16)
    }
}
