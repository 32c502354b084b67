//! The filter of `voltstep-bms` as a user of `minikalman` would write it: two states (state of
//! charge, error of the model's voltage), one measurement, the model's voltage as a function.

use minikalman::buffers::types::{
    DirectProcessNoiseCovarianceMatrixMutBuffer, EstimateCovarianceMatrixBuffer,
    InnovationCovarianceMatrixBuffer, InnovationVectorBuffer, KalmanGainMatrixBuffer,
    MeasurementNoiseCovarianceMatrixBuffer, MeasurementVectorBuffer, ObservationMatrixMutBuffer,
    PredictedStateEstimateVectorBuffer, StateTransitionMatrixMutBuffer, StateVectorBuffer,
    TemporaryHPMatrixBuffer, TemporaryKHPMatrixBuffer, TemporaryPHTMatrixBuffer,
    TemporaryResidualCovarianceInvertedMatrixBuffer, TemporaryStateMatrixBuffer,
};
use minikalman::extended::{
    ExtendedKalman, ExtendedKalmanBuilder, ExtendedObservation, ExtendedObservationBuilder,
};
use minikalman::matrix::MatrixDataArray;
use minikalman::prelude::*;
use minikalman::{
    impl_buffer_A, impl_buffer_H, impl_buffer_K, impl_buffer_P, impl_buffer_Q_direct,
    impl_buffer_R, impl_buffer_S, impl_buffer_temp_HP, impl_buffer_temp_KHP, impl_buffer_temp_P,
    impl_buffer_temp_PHt, impl_buffer_temp_S_inv, impl_buffer_temp_x, impl_buffer_x, impl_buffer_y,
    impl_buffer_z,
};
use plant_core::battery::Resistances;
use plant_core::num::lag_gain;
use plant_core::presets::PANASONIC_NCR18650PF as CELL;

use crate::estimators::SAMPLE;

type Two = MatrixDataArray<2, 1, 2, f32>;
type TwoByTwo = MatrixDataArray<2, 2, 4, f32>;
type Row = MatrixDataArray<1, 2, 2, f32>;
type One = MatrixDataArray<1, 1, 1, f32>;

type Filter = ExtendedKalman<
    2,
    f32,
    StateTransitionMatrixMutBuffer<2, f32, TwoByTwo>,
    StateVectorBuffer<2, f32, Two>,
    EstimateCovarianceMatrixBuffer<2, f32, TwoByTwo>,
    DirectProcessNoiseCovarianceMatrixMutBuffer<2, f32, TwoByTwo>,
    PredictedStateEstimateVectorBuffer<2, f32, Two>,
    TemporaryStateMatrixBuffer<2, f32, TwoByTwo>,
>;
type Observation = ExtendedObservation<
    2,
    1,
    f32,
    ObservationMatrixMutBuffer<1, 2, f32, Row>,
    MeasurementVectorBuffer<1, f32, One>,
    MeasurementNoiseCovarianceMatrixBuffer<1, f32, One>,
    InnovationVectorBuffer<1, f32, One>,
    InnovationCovarianceMatrixBuffer<1, f32, One>,
    KalmanGainMatrixBuffer<2, 1, f32, Two>,
    TemporaryResidualCovarianceInvertedMatrixBuffer<1, f32, One>,
    TemporaryHPMatrixBuffer<1, 2, f32, Row>,
    TemporaryPHTMatrixBuffer<2, 1, f32, Two>,
    TemporaryKHPMatrixBuffer<2, f32, TwoByTwo>,
>;

/// What a step takes for noise \[V²\]: 20 % of 60 mΩ at half the capacity in an hour, correlated
/// over ten seconds.
const NOISE_V2: f32 = 0.065;
/// What a step adds to the variance of the state of charge.
const DRIFT: f32 = 3e-9;
/// The share of the model's error that a step keeps.
const KEEP: f32 = 0.9995;
/// Variance of the model's error \[V²\].
const ERROR_V2: f32 = 2e-4;
const SOC_PER_A: f32 = SAMPLE.s() / (3600.0 * CELL.capacity_ah);
const GAINS: [f32; 2] = [
    lag_gain(SAMPLE.s() / CELL.polarisation.time_constant_s),
    lag_gain(SAMPLE.s() / CELL.second_polarisation.time_constant_s),
];

/// The filter, and what its model remembers.
pub struct Kalman {
    filter: Filter,
    observation: Observation,
    polarisation_v: [f32; 2],
    resistances: Resistances,
}

impl Kalman {
    /// Told a state of charge, with its standard deviation.
    #[must_use]
    pub fn new(soc: f32, soc_sd: f32) -> Self {
        impl_buffer_A!(mut transition, 2, f32, 0.0);
        impl_buffer_x!(mut state, 2, f32, 0.0);
        impl_buffer_P!(mut covariance, 2, f32, 0.0);
        impl_buffer_Q_direct!(mut process, 2, f32, 0.0);
        impl_buffer_temp_x!(predicted, 2, f32, 0.0);
        impl_buffer_temp_P!(temporary, 2, f32, 0.0);
        transition.apply(|a| a.set_at(0, 0, 1.0));
        transition.apply(|a| a.set_at(1, 1, KEEP));
        state.apply(|x| x.set_at(0, 0, soc));
        covariance.apply(|p| p.set_at(0, 0, soc_sd * soc_sd));
        covariance.apply(|p| p.set_at(1, 1, ERROR_V2));
        process.apply(|q| q.set_at(0, 0, DRIFT));
        process.apply(|q| q.set_at(1, 1, ERROR_V2 * (1.0 - KEEP * KEEP)));
        impl_buffer_H!(mut slopes, 1, 2, f32, 1.0);
        impl_buffer_z!(measured, 1, f32, 0.0);
        impl_buffer_R!(noise, 1, f32, NOISE_V2);
        impl_buffer_y!(innovation, 1, f32, 0.0);
        impl_buffer_S!(residual, 1, f32, 0.0);
        impl_buffer_K!(gain, 2, 1, f32, 0.0);
        impl_buffer_temp_S_inv!(inverse, 1, f32, 0.0);
        impl_buffer_temp_HP!(of_row, 1, 2, f32, 0.0);
        impl_buffer_temp_PHt!(of_column, 2, 1, f32, 0.0);
        impl_buffer_temp_KHP!(of_gain, 2, f32, 0.0);
        slopes.apply(|h| h.set_at(0, 0, 1.0));
        Self {
            filter: ExtendedKalmanBuilder::new::<2, f32>(
                transition, state, covariance, process, predicted, temporary,
            ),
            observation: ExtendedObservationBuilder::new::<2, 1, f32>(
                slopes, measured, noise, innovation, residual, gain, inverse, of_row, of_column,
                of_gain,
            ),
            polarisation_v: [0.0; 2],
            resistances: Resistances::default(),
        }
    }

    /// What is left to a slower rate here, too.
    pub fn follow(&mut self, resistances: Resistances) {
        self.resistances = resistances;
    }

    /// The state of charge.
    #[must_use]
    pub fn soc(&self) -> f32 {
        self.filter.state_vector().as_matrix().get_at(0, 0)
    }

    /// Prediction and correction; the state of charge.
    #[inline(always)]
    pub fn step(&mut self, current_a: f32, voltage_v: f32) -> f32 {
        let mut drop_v = self.resistances.series_ohm * current_a;
        for ((v, gain), ohm) in
            self.polarisation_v.iter_mut().zip(GAINS).zip(self.resistances.polarisation_ohm)
        {
            *v += gain * (ohm * current_a - *v);
            drop_v += *v;
        }
        self.filter.predict_nonlinear(|now, next| {
            let (soc, error_v) = (now.get_row(0), now.get_row(1));
            next.set_row(0, soc - current_a * SOC_PER_A);
            next.set_row(1, KEEP * error_v);
        });
        let (open_circuit_v, slope_v) = CELL.open_circuit.with_slope(self.soc());
        self.observation.observation_jacobian_matrix_mut().apply(|h| h.set_at(0, 0, slope_v));
        self.observation.measurement_vector_mut().apply(|z| z.set_at(0, 0, voltage_v));
        self.filter.correct_nonlinear(&mut self.observation, |state, expected| {
            expected.set_row(0, open_circuit_v + state.get_row(1) - drop_v);
        });
        self.soc()
    }
}
