mod driver;
mod machine;
mod mutants;
mod plant;
mod precharge;
mod properties;
mod walk;
